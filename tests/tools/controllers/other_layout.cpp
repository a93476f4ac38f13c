// A controller with a different memory layout. Compiled with OTHER_ABI it exports the layout's number; without, it
// exports none, as with headers that aren't Rehearse's.
#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT void* createSimpleController() { return nullptr; }
#ifdef OTHER_ABI
EXPORT int rehearseCnoidAbi() { return OTHER_ABI; }
#endif
