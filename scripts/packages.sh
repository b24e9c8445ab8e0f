# Sourced by the scripts: the Debian packages Taut uses, and how to install those that are missing.

build_packages=(g++ cmake ninja-build pkg-config libopenmpi-dev openmpi-bin libpetsc-real-dev libmetis-dev libptscotch-dev
  libhdf5-openmpi-dev zlib1g-dev libopenblas0-serial libeigen3-dev libboost-dev libembree-dev libcgal-dev libgeos-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libgtest-dev libgmock-dev libbenchmark-dev)
test_packages=(python3 python3-pip python3-setuptools python3-yaml python3-h5py python3-numpy python3-matplotlib)
check_packages=(clang clang-format clang-tidy git python3 flake8 mypy)
sanitize_packages=(clang libclang-rt-dev llvm valgrind)
pvpython_packages=(python3-h5py python3-numpy python3-yaml) # what scripts/render.py imports
picture_packages=(python3-paraview paraview xvfb ffmpeg "${pvpython_packages[@]}")

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

# configure PRESET [OPTION...]: the build folder of CMakePresets.json; says something only if it fails.
configure() {
  mkdir -p build
  cmake --preset "$@" > build/configure.log 2>&1 || { cat build/configure.log; return 1; }
}

set -a
source "$(dirname "${BASH_SOURCE[0]}")/taut/mpi.env"
set +a
