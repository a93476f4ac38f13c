// The interposer's side of harness/src/audit/interposer.h.
extern "C" __attribute__((visibility("default"))) void rehearse_interposer_enter(const char*, const char*, const char*,
                                                                                 long long, double) {}
extern "C" __attribute__((visibility("default"))) void rehearse_interposer_leave() {}
