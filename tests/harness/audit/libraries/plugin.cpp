// A library that a watched library finds by its own run path.
extern "C" int plugin() { return 1; }
