/* A program that knows nothing of Rehearse, and loads a library that sets variables: plain_program LIBRARY. With
   LISTENS it defines what the harness defines. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#ifdef LISTENS
void rehearse_record_variable(const char* name, double value);
void rehearse_record_variable(const char* name, double value) { printf("%s=%g ", name, value); }
#endif

int main(int argc, char** argv) {
  void* library = argc == 2 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
  int (*speak)(void) = NULL;
  void* symbol = library ? dlsym(library, "speak") : NULL;
  if (!symbol) return fprintf(stderr, "%s\n", dlerror()), 1;
  memcpy(&speak, &symbol, sizeof speak);
  printf("%d\n", speak());
  return 0;
}
