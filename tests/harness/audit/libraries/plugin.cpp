// A library that a watched one finds by a run path of its own.
extern "C" int plugin() { return 1; }
