# Sourced by the scripts: the Debian packages Taut uses, and how to install those that are missing.

build_packages=(g++ cmake ninja-build pkg-config libopenmpi-dev openmpi-bin libpetsc-real-dev libmetis-dev libptscotch-dev
  libhdf5-openmpi-dev libopenblas0-serial libeigen3-dev libboost-dev libembree-dev libcgal-dev libgeos-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libgtest-dev libgmock-dev libbenchmark-dev)
test_packages=(python3 python3-yaml python3-h5py python3-numpy python3-matplotlib)
check_packages=(clang clang-format clang-tidy git python3)
sanitize_packages=(clang libclang-rt-dev llvm valgrind)
picture_packages=(python3-paraview paraview xvfb ffmpeg)

# install_missing PACKAGE...: asks apt only for what is not there, so a second call takes no time.
install_missing() {
  local missing=()
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2> /dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  command -v apt-get > /dev/null || {
    echo "Taut needs these Debian packages, or what they hold: ${missing[*]}" >&2
    return 1
  }
  local as_root=()
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  echo "installing: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
}

# mpirun refuses root and more ranks than cores unless told that it is meant.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
