// A shared library without a factory: it isn't a controller.
extern "C" int answer() { return 42; }
