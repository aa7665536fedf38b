# Writes a C++ source with a function that returns text files, every byte as \xNN:
#   cmake -DOUTPUT=x.cpp -DHEADER=robot/file/material_library.hpp -DNAMESPACE=pliant::robot -DFUNCTION=library_files
#         "-DFILES=name=path;path..." -P EmbedFiles.cmake
# A file without a name before it is called as on the disk, without its extension.
set(text "// Made by cmake/EmbedFiles.cmake.\n#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\n")
string(APPEND text "std::span<const EmbeddedFile> ${FUNCTION}() {\n    static constexpr EmbeddedFile files[] = {\n")
foreach(entry IN LISTS FILES)
  if(entry MATCHES "^([a-z_0-9]+)=(.*)$")
    set(name "${CMAKE_MATCH_1}")
    set(path "${CMAKE_MATCH_2}")
  else()
    set(path "${entry}")
    get_filename_component(name "${path}" NAME_WLE)
  endif()
  file(READ "${path}" content HEX)
  string(REGEX REPLACE "(..)" "\\\\x\\1" content "${content}")
  string(APPEND text "        {\"${name}\", \"${content}\"},\n")
endforeach()
string(APPEND text "    };\n    return files;\n}\n\n}  // namespace ${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${text}")
