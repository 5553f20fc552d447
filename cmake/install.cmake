# What `cmake --install` puts where, and the files by which other projects find
# it: the CMake package ipc, and ipc.pc for pkg-config.
include(CMakePackageConfigHelpers)

# What completes the command line of a program, for each shell: from the folder of its sources.
function(install_completions program folder)
    set(completions ${PROJECT_SOURCE_DIR}/${folder}/completions)
    install(FILES ${completions}/${program}.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
    install(FILES ${completions}/_${program}
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
    install(FILES ${completions}/${program}.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endfunction()

install(TARGETS ipc EXPORT ipcTargets
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET ipc_static)
    install(TARGETS ipc_static EXPORT ipcTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
if(TARGET central)
    install(TARGETS central killCentral killModule RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    install(FILES ${PROJECT_SOURCE_DIR}/src/c/shell/killCentral.1
                  ${PROJECT_SOURCE_DIR}/src/c/shell/killModule.1
        DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
    install(FILES ${PROJECT_SOURCE_DIR}/src/c/central/central.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8)
    install_completions(central src/c/central)
    install_completions(killCentral src/c/shell)
    install_completions(killModule src/c/shell)
    # The commands find the library of their own prefix, wherever that is.
    file(RELATIVE_PATH bin_to_lib ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
    set_target_properties(killCentral killModule PROPERTIES INSTALL_RPATH $ORIGIN/${bin_to_lib})
endif()
if(TARGET central AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(units ${PROJECT_BINARY_DIR}/src/c/central/systemd)
    # The prefix may be another one than when the build was configured.
    install(CODE "
        set(CENTRAL_BINDIR \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\")
        configure_file(\"${PROJECT_SOURCE_DIR}/src/c/central/systemd/central.service.in\"
            \"${units}/central.service\" @ONLY)")
    install(FILES ${units}/central.service ${units}/central.socket
        DESTINATION ${IPC_SYSTEMD_UNIT_DIR})
endif()
if(TARGET xdrgen)
    install(TARGETS xdrgen EXPORT ipcXdrgenTargets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    install(FILES ${PROJECT_SOURCE_DIR}/xdrgen/xdrgen.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
    install_completions(xdrgen xdrgen)
    install(FILES ${PROJECT_SOURCE_DIR}/xdrgen/ipcXdrgen.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ipc)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/include/ipc/ipc.h
              ${PROJECT_SOURCE_DIR}/include/ipc/ipcx.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ipc)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/Windows/README.md ${PROJECT_SOURCE_DIR}/Windows/ipc.def
    DESTINATION ${CMAKE_INSTALL_DOCDIR}/Windows) # the other documents speak of it

if(IPC_TOP_LEVEL)
    add_custom_target(uninstall
        COMMAND ${CMAKE_COMMAND} -D MANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt
            -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake
        COMMENT "Removing what the last installation from this build has installed"
        USES_TERMINAL VERBATIM)
endif()

# find_package(ipc).  Programs of CMU IPC 3.9 work with this version, so a
# request for an older one is met.
set(IPC_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/ipc)
configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/cmake/ipcConfig.cmake.in
    ${PROJECT_BINARY_DIR}/cmake/ipcConfig.cmake
    INSTALL_DESTINATION ${IPC_PACKAGE_DIR})
write_basic_package_version_file(
    ${PROJECT_BINARY_DIR}/cmake/ipcConfigVersion.cmake
    COMPATIBILITY AnyNewerVersion)
install(FILES
    ${PROJECT_BINARY_DIR}/cmake/ipcConfig.cmake
    ${PROJECT_BINARY_DIR}/cmake/ipcConfigVersion.cmake
    DESTINATION ${IPC_PACKAGE_DIR})
install(EXPORT ipcTargets NAMESPACE ipc:: DESTINATION ${IPC_PACKAGE_DIR})
if(TARGET xdrgen)
    # In a file of its own, so that the library can be installed without.
    install(EXPORT ipcXdrgenTargets NAMESPACE ipc:: DESTINATION ${IPC_PACKAGE_DIR})
endif()

# ipc.pc finds its prefix from where it lies itself, so that --prefix at install
# time and DESTDIR are honoured.
set(pc_dir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH IPC_PC_PREFIX ${pc_dir} ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" IPC_PC_PREFIX "${IPC_PC_PREFIX}")
file(RELATIVE_PATH IPC_PC_LIBDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH IPC_PC_INCLUDEDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(IPC_PC_PRIVATE_LIBS ${CMAKE_THREAD_LIBS_INIT})
if(WIN32)
    set(IPC_PC_PRIVATE_LIBS "-lws2_32 -liphlpapi")
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/ipc.pc.in ${PROJECT_BINARY_DIR}/cmake/ipc.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/cmake/ipc.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
