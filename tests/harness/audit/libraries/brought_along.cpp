// A library to which a watched library is linked.
#include <cstdlib>

double brought_along() { return rand(); }
