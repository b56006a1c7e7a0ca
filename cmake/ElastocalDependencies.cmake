# The packages that the library needs, in one list for this build and for the installed
# elastocalConfig.cmake: each entry is a name and, where it matters, the least version.
set(ELASTOCAL_DEPENDENCIES
  "Eigen3 3.4"
  "Boost"
  "Ceres 2.1"
  "Ipopt"
  "mujoco 2.2.2"
  "pugixml"
  "OpenSSL"
  "yaml-cpp"
  "nlohmann_json"
  "fmt"
  "Threads")
