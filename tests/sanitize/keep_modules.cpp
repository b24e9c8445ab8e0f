// Keeps the modules of MPI loaded, so that LeakSanitizer knows at the end which of them did not free its
// memory.
extern "C" int dlclose(void*) { return 0; }
