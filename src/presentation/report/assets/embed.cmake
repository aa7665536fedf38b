# Writes a C++ source that holds text files as string literals, every byte as \xNN:
#   cmake -DOUTPUT=assets.cpp "-DFILES=name=path;name=path" -P embed.cmake
# References to source maps are left out: a page that stands alone has none.
set(text "// Made by assets/embed.cmake.\n#include \"presentation/report/assets.hpp\"\n\nnamespace pliant::report::assets {\n\n")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([a-z_]+)=(.*)$" matched "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" content)
  string(REGEX REPLACE "/[/*]# sourceMappingURL=[^\n]*" "" content "${content}")
  string(HEX "${content}" content)
  string(REGEX REPLACE "(..)" "\\\\x\\1" content "${content}")
  string(APPEND text "const std::string_view ${name} = \"${content}\";\n\n")
endforeach()
string(APPEND text "}  // namespace pliant::report::assets\n")
file(WRITE "${OUTPUT}" "${text}")
