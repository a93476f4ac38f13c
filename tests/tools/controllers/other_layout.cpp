// A controller of another memory layout. Compiled with OTHER_ABI it says which; without, as with headers that aren't ours,
// it says nothing.
#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT void* createSimpleController() { return nullptr; }
#ifdef OTHER_ABI
EXPORT int rehearseCnoidAbi() { return OTHER_ABI; }
#endif
