# What is installed beside programs and library: man pages, completion, examples, documentation, desktop entry, service.
set(PLIANT_ZSH_FOLDER ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING
    "Where zsh looks for completion, below the prefix")
set(PLIANT_UNIT_FOLDER lib/systemd/system CACHE STRING "Where systemd looks for units, below the prefix")

# Made from the program's own table of commands and options.
set(share ${PROJECT_BINARY_DIR}/share)
add_custom_command(
  OUTPUT ${share}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${share}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${share}/completion
  COMMAND ${PROJECT_SOURCE_DIR}/tools/manual_pages $<TARGET_FILE:pliant_cli> ${share}/man
  COMMAND $<TARGET_FILE:pliant_cli> completion bash > ${share}/completion/pliant
  COMMAND $<TARGET_FILE:pliant_cli> completion zsh > ${share}/completion/_pliant
  COMMAND $<TARGET_FILE:pliant_cli> completion fish > ${share}/completion/pliant.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${share}/made
  DEPENDS pliant_cli ${PROJECT_SOURCE_DIR}/tools/manual_pages
  COMMENT "Writing man pages and completion"
  VERBATIM)
add_custom_target(pliant_share ALL DEPENDS ${share}/made)
install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
install(FILES ${share}/completion/pliant DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT programs)
install(FILES ${share}/completion/_pliant DESTINATION ${PLIANT_ZSH_FOLDER} COMPONENT programs)
install(FILES ${share}/completion/pliant.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
        COMPONENT programs)

set(data ${PROJECT_SOURCE_DIR}/data)
install(FILES ${data}/desktop/pliant-studio.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT programs)
install(FILES ${data}/desktop/pliant.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
        COMPONENT programs)
configure_file(${data}/service/pliant-studio.service.in ${PROJECT_BINARY_DIR}/pliant-studio.service @ONLY)
# The service names the program's place, which `cmake --install --prefix` may change: it is written again there.
install(CODE "get_filename_component(prefix \"\${CMAKE_INSTALL_PREFIX}\" ABSOLUTE)
get_filename_component(CMAKE_INSTALL_FULL_BINDIR \"${CMAKE_INSTALL_BINDIR}\" ABSOLUTE BASE_DIR \"\${prefix}\")
configure_file(\"${data}/service/pliant-studio.service.in\"
               \"${PROJECT_BINARY_DIR}/installed/pliant-studio.service\" @ONLY)"
        COMPONENT programs)
install(FILES ${PROJECT_BINARY_DIR}/installed/pliant-studio.service DESTINATION ${PLIANT_UNIT_FOLDER}
        COMPONENT programs)
install(FILES ${data}/service/60-pliant-printer.rules DESTINATION ${CMAKE_INSTALL_DATADIR}/pliant COMPONENT programs)

# The folder of examples stands beside nothing that it needs; what builds and tests it stays here.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs
        USE_SOURCE_PERMISSIONS REGEX "/examples/(CMakeLists\\.txt|[^/]*\\.cpp|print_all)$" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/firmware DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/LICENSES.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
# The documentation as pages, where tools/site has made them.
install(DIRECTORY ${PROJECT_BINARY_DIR}/site/html DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc OPTIONAL)
