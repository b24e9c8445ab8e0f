# Sourced by the scripts: programs that watch their own memory and arithmetic, and valgrind, which watches any.

export ASAN_OPTIONS=detect_stack_use_after_return=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=$PWD/tests/sanitize/leaks.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export OMPI_MCA_opal_signal= # no handler of MPI's: libFuzzer's own keeps the input that was found

# The build in build-sanitize: clang++, AddressSanitizer, UBSan, assertions of Eigen and of the C++ library, fuzzers.
configure_sanitized() {
  install_missing "${build_packages[@]}" "${test_packages[@]}" "${sanitize_packages[@]}"
  [ -f build-sanitize/build.ninja ] || configure sanitize
}

# A small run of build/taut; what valgrind says about a rank is shown, and is a failure.
run_under_valgrind() {
  local folder ranks
  folder=$(mktemp -d)
  for ranks in 1 2; do
    if ! mpirun --oversubscribe --bind-to none -n "$ranks" \
        valgrind -q --error-exitcode=9 --num-callers=40 --leak-check=full --show-leak-kinds=definite \
        --errors-for-leak-kinds=definite --suppressions=/usr/share/openmpi/openmpi-valgrind.supp \
        --suppressions=tests/sanitize/valgrind.supp --log-file="$folder/rank.%p.log" \
        build/taut run tests/sanitize/small.yaml --out "$folder/run$ranks" > "$folder/run.log" 2>&1; then
      cat "$folder"/*.log >&2
      rm -rf "$folder"
      echo "valgrind found something at $ranks ranks" >&2
      return 1
    fi
    echo "valgrind: nothing found at $ranks ranks"
  done
  rm -rf "$folder"
}
