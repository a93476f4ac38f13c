/* A library that sets variables and asks for its state. Linked to nothing of ours. C and C++. */
#include <rehearse_state.h>
#include <rehearse_variable.h>

#ifdef __cplusplus
extern "C"
#endif
__attribute__((visibility("default"))) int speak(void);

int speak(void) {
  rehearse_variable("phase", 0.25);
  rehearse_variable("phase", 0.5);
  double integral = 42.0;
  return rehearse_state("integral", &integral) ? 0 : (int)integral; /* neither program gives a state */
}
