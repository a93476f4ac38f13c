/* A library that sets variables. Linked to nothing of ours. C and C++. */
#include <rehearse_variable.h>

#ifdef __cplusplus
extern "C"
#endif
__attribute__((visibility("default"))) int speak(void);

int speak(void) {
  rehearse_variable("phase", 0.25);
  rehearse_variable("phase", 0.5);
  return 42;
}
