# pliant_embed(OUTPUT HEADER <header that declares it> NAMESPACE <its namespace> FUNCTION <its name>
#              FILES <path or name=path>...)
# makes the source OUTPUT, whose function returns the files as a span of EmbeddedFile (base/core/embedded_file.hpp).
function(pliant_embed output)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "HEADER;NAMESPACE;FUNCTION" "FILES")
  set(script ${PROJECT_SOURCE_DIR}/cmake/EmbedFiles.cmake)
  set(paths ${arg_FILES})
  list(TRANSFORM paths REPLACE "^[a-z_0-9]+=" "")
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DHEADER=${arg_HEADER} -DNAMESPACE=${arg_NAMESPACE}
            -DFUNCTION=${arg_FUNCTION} "-DFILES=${arg_FILES}" -P ${script}
    DEPENDS ${paths} ${script}
    VERBATIM)
endfunction()
