# Installs the unit with the paths of this prefix in it, and the configuration that it names unless there is one already.
# Variables: deploy_dir, COLLIDED_UNIT_DIR, CMAKE_INSTALL_BINDIR, CMAKE_INSTALL_SYSCONFDIR and CMAKE's own of an installation.
function(absolute variable folder)
  cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}" NORMALIZE)
  set(${variable} "${folder}" PARENT_SCOPE)
endfunction()
absolute(bin_dir "${CMAKE_INSTALL_BINDIR}")
absolute(config_dir "${CMAKE_INSTALL_SYSCONFDIR}/collided")
absolute(unit_dir "${COLLIDED_UNIT_DIR}")

file(READ "${deploy_dir}/collided.service" unit)
string(REPLACE "/usr/local/bin/" "${bin_dir}/" unit "${unit}")
string(REPLACE "/etc/collided/" "${config_dir}/" unit "${unit}")
set(unit_file "$ENV{DESTDIR}${unit_dir}/collided.service")
message(STATUS "Installing: ${unit_file}")
file(WRITE "${unit_file}" "${unit}")
file(CHMOD "${unit_file}" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${unit_dir}/collided.service")

if(EXISTS "$ENV{DESTDIR}${config_dir}/collided.toml")
  message(STATUS "Kept: $ENV{DESTDIR}${config_dir}/collided.toml")
else()
  file(INSTALL DESTINATION "${config_dir}" TYPE FILE FILES "${deploy_dir}/collided.toml")
endif()
