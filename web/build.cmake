# Builds the page in a copy of web/ beside the other build products, and writes BUILD/page.cpp.
#   cmake -DSOURCE=web -DBUILD=build/release/web -DENABLED=ON|OFF|REQUIRED -P build.cmake
find_program(NODE NAMES node nodejs)
find_program(NPM npm)

function(write_missing_page why)
  if(ENABLED STREQUAL "REQUIRED")
    message(FATAL_ERROR "the studio's page is not built: ${why}")
  endif()
  message(WARNING "the studio's page is not built: ${why}. Delete ${BUILD} to try again")
  file(READ ${SOURCE}/missing.html content HEX)
  string(REGEX REPLACE "(..)" "\\\\x\\1" content "${content}")
  file(WRITE ${BUILD}/page.cpp
       "// Made by web/build.cmake.\n#include \"studio/built_in/examples.hpp\"\n\nnamespace pliant::studio {\n\n"
       "std::span<const PageFile> page_files() {\n    static constexpr PageFile files[] = {"
       "{\"/\", \"text/html; charset=utf-8\", \"${content}\", false}};\n    return files;\n}\n\n"
       "}  // namespace pliant::studio\n")
  file(WRITE ${BUILD}/viewer.js "document.getElementById('viewer').textContent = 'The viewer was not built: ${why}.';\n")
endfunction()

file(MAKE_DIRECTORY ${BUILD})
if(NOT ENABLED)
  write_missing_page("PLIANT_PAGE is OFF")
  return()
endif()
if(NOT NODE OR NOT NPM)
  write_missing_page("node and npm are needed")
  return()
endif()

file(REMOVE_RECURSE ${BUILD}/src ${BUILD}/dist ${BUILD}/dist_viewer)
foreach(name src index.html package.json package-lock.json .npmrc tsconfig.json vite.config.ts viewer.config.ts embed.mjs notices.mjs)
  file(COPY ${SOURCE}/${name} DESTINATION ${BUILD})
endforeach()

# The packages are fetched once for each lock file.
file(SHA256 ${BUILD}/package-lock.json lock)
set(installed "")
if(EXISTS ${BUILD}/node_modules/.pliant_lock)
  file(READ ${BUILD}/node_modules/.pliant_lock installed)
endif()
if(NOT installed STREQUAL lock)
  execute_process(COMMAND ${NPM} ci --ignore-scripts --loglevel=error WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE failed)
  if(failed)
    write_missing_page("npm could not fetch its packages")
    return()
  endif()
  file(WRITE ${BUILD}/node_modules/.pliant_lock ${lock})
endif()

foreach(step "node_modules/typescript/bin/tsc;--noEmit" "node_modules/vite/bin/vite.js;build;--logLevel;warn"
        "node_modules/vite/bin/vite.js;build;--config;viewer.config.ts;--logLevel;warn" "notices.mjs;dist/notices.txt"
        "embed.mjs;dist;page.cpp")
  execute_process(COMMAND ${NODE} ${step} WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "building the studio's page failed: node ${step}")
  endif()
endforeach()

# The viewer of notebooks carries the notices of what it holds.
file(READ ${BUILD}/dist_viewer/viewer.js viewer)
file(READ ${BUILD}/dist/notices.txt notices)
file(WRITE ${BUILD}/viewer.js "/*\n${notices}\n*/\n${viewer}")
