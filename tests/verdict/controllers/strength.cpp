extern "C" double strength() { return STRENGTH; }
