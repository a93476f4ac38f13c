// A library that a watched one links to.
#include <cstdlib>

double brought_along() { return rand(); }
