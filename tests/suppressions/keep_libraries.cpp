// Linked into programs with sanitizers: libraries stay loaded until the end. A leak of a driver that
// was unloaded before the report has no name left, and no suppression matches it.
extern "C" int dlclose(void*);
extern "C" int dlclose(void*) {
  return 0;
}
