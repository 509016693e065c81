# foresight_module(NAME SOURCES a.cpp ... [SHADERS x.comp ...] [LINK target ...])
#
# The files of a module may be compiled together (FORESIGHT_UNITY): what they keep to themselves has names of its own.
#
# One static library per module folder. Headers are included from the project
# root ("common/lens.hpp"), so a reader sees in every #include which module is used.
# Shaders lie beside the pass that runs them; they are embedded into the library
# and reached as <name>_shaders() (gl/program.hpp).

add_library(foresight_options INTERFACE)
target_compile_options(foresight_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                   -Wcast-align -Woverloaded-virtual)
target_include_directories(foresight_options INTERFACE ${PROJECT_SOURCE_DIR})
if(FORESIGHT_SANITIZE)
  target_compile_options(foresight_options INTERFACE -fsanitize=${FORESIGHT_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all)
  if(FORESIGHT_SANITIZE MATCHES address)
    # Eigen would have an allocator of its own there, and free with it what libraries without sanitizers have allocated.
    target_compile_definitions(foresight_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
  target_link_options(foresight_options INTERFACE -fsanitize=${FORESIGHT_SANITIZE})
  add_library(foresight_keep_libraries OBJECT ${PROJECT_SOURCE_DIR}/tests/suppressions/keep_libraries.cpp)
  target_link_libraries(foresight_options INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:foresight_keep_libraries>>)
endif()

# Compiled together, files take a few hundred MB that are mostly kept to the end: collecting garbage only costs time.
if(FORESIGHT_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(foresight_options INTERFACE --param=ggc-min-expand=300 --param=ggc-min-heapsize=1000000)
endif()

# The third-party headers are by far the most expensive part of a build: one
# precompiled header serves all modules.
set(FORESIGHT_PCH_HEADERS <array> <cmath> <cstdint> <filesystem> <functional> <memory> <optional> <span> <string>
                          <vector> <Eigen/Geometry> <opencv2/core.hpp>)

function(foresight_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;SHADERS;LINK" ${ARGN})
  set(target foresight_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  target_link_libraries(${target} PUBLIC foresight_options ${ARG_LINK})
  if(FORESIGHT_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 24)
  endif()
  if(ARG_SHADERS)
    foresight_embed_shaders(${target} ${name} ${ARG_SHADERS})
  endif()
  if(name STREQUAL "common")
    target_precompile_headers(${target} PRIVATE ${FORESIGHT_PCH_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM foresight_common)
  endif()
endfunction()

function(foresight_embed_shaders target name)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}_shaders.cpp)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE inputs)
  list(JOIN inputs "|" joined)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DNAME=${name} "-DINPUTS=${joined}"
            -P ${PROJECT_SOURCE_DIR}/cmake/EmbedShaders.cmake
    DEPENDS ${inputs} ${PROJECT_SOURCE_DIR}/cmake/EmbedShaders.cmake
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
