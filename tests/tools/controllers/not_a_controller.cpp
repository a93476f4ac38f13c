// A shared library, but not one of a controller: it has no factory.
extern "C" int answer() { return 42; }
