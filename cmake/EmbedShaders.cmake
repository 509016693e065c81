# Writes OUTPUT, a C++ file that holds the text of each shader in INPUTS ("|" between
# them) and defines `const ShaderSources& NAME_shaders()` (gl/program.hpp).
string(REPLACE "|" ";" inputs "${INPUTS}")
set(text "#include \"gl/program.hpp\"\n\nnamespace foresight::gl {\n\n")
string(APPEND text "const ShaderSources& ${NAME}_shaders() {\n  static const ShaderSources sources = {\n")
foreach(input IN LISTS inputs)
  get_filename_component(file ${input} NAME)
  file(READ ${input} body)
  string(APPEND text "      {\"${file}\", R\"GLSL(${body})GLSL\"},\n")
endforeach()
string(APPEND text "  };\n  return sources;\n}\n\n}  // namespace foresight::gl\n")
file(WRITE ${OUTPUT} "${text}")
