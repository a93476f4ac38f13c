// A controller of another memory layout. Compiled with OTHER_ABI it says which; without, as with headers that aren't ours,
// it says nothing.
extern "C" void* createSimpleController() { return nullptr; }
#ifdef OTHER_ABI
extern "C" int rehearseCnoidAbi() { return OTHER_ABI; }
#endif
