# Writes OUTPUT, a C++ file that defines `const std::string_view NAME`, in namespace foresight,
# as the text of the file INPUT.
file(READ ${INPUT} body)
file(WRITE ${OUTPUT} "#include <string_view>\n\nnamespace foresight {\n\n"
     "extern const std::string_view ${NAME};\n"
     "const std::string_view ${NAME} = R\"EMBEDDED(${body})EMBEDDED\";\n\n}  // namespace foresight\n")
