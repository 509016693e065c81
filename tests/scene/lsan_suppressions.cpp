// What leaks in the libraries when they refuse a damaged file, and is not ours to mend: assimp
// drops half-read scenes, and urdfdom's links hold each other where joints form a circle.
// LeakSanitizer asks for this function; without it nobody calls it.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp.so\nleak:urdf::parseURDF\n";
}
