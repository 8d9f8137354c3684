# `cpack` writes tubebin_VERSION_ARCH.deb, whose dependencies dpkg-shlibdeps reads off the programs, and libtubebin-dev_..., whose
# libraries are static: a program that links them needs what they are made of.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the tubebin authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tubebin libtubebin-dev)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

set(CPACK_DEBIAN_TUBEBIN_PACKAGE_NAME tubebin)
set(CPACK_DEBIAN_TUBEBIN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TUBEBIN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TUBEBIN_PACKAGE_RECOMMENDS "libosmesa6")  # previews load it where it is
# Debian's editors have a program `view`, too, which alternatives choose. Ours has a name of its own beside it there, and is
# `view` where no other is: its priority is lower than theirs.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian/rename_view.cmake)
set(CPACK_DEBIAN_TUBEBIN_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/cmake/debian/postinst ${PROJECT_SOURCE_DIR}/cmake/debian/prerm)
set(CPACK_COMPONENT_TUBEBIN_DESCRIPTION "Programs that generate, scan, model and evaluate bins of entangled tubes")

set(CPACK_DEBIAN_LIBTUBEBIN-DEV_PACKAGE_NAME libtubebin-dev)
set(CPACK_DEBIAN_LIBTUBEBIN-DEV_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_LIBTUBEBIN-DEV_PACKAGE_DEPENDS
       libode-dev libembree-dev libpng-dev zlib1g-dev liblzf-dev libeigen3-dev libyaml-cpp-dev
       nlohmann-json3-dev libfmt-dev libxxhash-dev libarchive-dev libsleef-dev libtbb-dev pkg-config)
set(CPACK_COMPONENT_LIBTUBEBIN-DEV_DESCRIPTION "Libraries, headers and CMake package of tubebin")
include(CPack)
