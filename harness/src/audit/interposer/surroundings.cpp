// Queries of a controller about its process, and changes to it. machine.cpp has the queries about the machine.
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

const char* name_of_category(int category) {
  switch (category) {
    case LC_ALL: return "LC_ALL";
    case LC_NUMERIC: return "LC_NUMERIC";
    case LC_CTYPE: return "LC_CTYPE";
    case LC_TIME: return "LC_TIME";
    case LC_COLLATE: return "LC_COLLATE";
    case LC_MONETARY: return "LC_MONETARY";
    case LC_MESSAGES: return "LC_MESSAGES";
    default: return "";
  }
}

}  // namespace

REHEARSE_NOTED(char*, getenv, (const char* name), (name), name)
REHEARSE_NOTED(char*, secure_getenv, (const char* name), (name), name)
REHEARSE_NOTED(int, setenv, (const char* name, const char* value, int overwrite), (name, value, overwrite), name)
REHEARSE_NOTED(int, unsetenv, (const char* name), (name), name)
REHEARSE_NOTED(int, putenv, (char* text), (text), text)
REHEARSE_NOTED(int, clearenv, (), (), "")
REHEARSE_NOTED(pid_t, getpid, (), (), "")
REHEARSE_NOTED(pid_t, gettid, (), (), "")
REHEARSE_NOTED(char*, getcwd, (char* to, size_t size), (to, size), "")
REHEARSE_NOTED(char*, get_current_dir_name, (), (), "")
REHEARSE_NOTED(unsigned long, getauxval, (unsigned long type), (type), Digits(static_cast<long long>(type)))

// They depend on the variable TZ and on the system's file of the time zone.
REHEARSE_NOTED(tm*, localtime, (const time_t* time), (time), "TZ")
REHEARSE_NOTED(tm*, localtime_r, (const time_t* time, tm* to), (time, to), "TZ")
REHEARSE_NOTED(time_t, mktime, (tm * time), (time), "TZ")
REHEARSE_NOTED(void, tzset, (), (), "TZ")

REHEARSE_INTERPOSED(char*, setlocale, (int category, const char* name)) {
  if (watching()) {
    char text[128];  // null is a query; for "" the environment determines the locale
    snprintf(text, sizeof text, name ? "%s, \"%s\"" : "%s, NULL", name_of_category(category), name);
    note(source_of::setlocale, "setlocale", text, __builtin_return_address(0));
  }
  return next_setlocale.get()(category, name);
}
REHEARSE_NOTED(locale_t, newlocale, (int mask, const char* name, locale_t base), (mask, name, base), name)
REHEARSE_NOTED(locale_t, __newlocale, (int mask, const char* name, locale_t base), (mask, name, base), name)
REHEARSE_NOTED(locale_t, uselocale, (locale_t to), (to), "")
REHEARSE_NOTED(lconv*, localeconv, (), (), "")

REHEARSE_NOTED(void, exit, (int status), (status), Digits(status))
REHEARSE_NOTED(void, _exit, (int status), (status), Digits(status))
REHEARSE_NOTED(void, _Exit, (int status), (status), Digits(status))
REHEARSE_NOTED(void, quick_exit, (int status), (status), Digits(status))
REHEARSE_NOTED(void, abort, (), (), "")
REHEARSE_NOTED(int, chdir, (const char* path), (path), path)
REHEARSE_NOTED(int, fchdir, (int folder), (folder), "")
REHEARSE_NOTED(mode_t, umask, (mode_t mask), (mask), "")
REHEARSE_NOTED(void*, dlopen, (const char* file, int mode), (file, mode), file)
REHEARSE_NOTED(int, raise, (int number), (number), Digits(number))
REHEARSE_NOTED(int, kill, (pid_t process, int number), (process, number), Digits(number))
REHEARSE_NOTED(sighandler_t, signal, (int number, sighandler_t handler), (number, handler), Digits(number))

// Without a new action or mask they are queries.
REHEARSE_INTERPOSED(int, sigaction, (int number, const void* action, void* before)) {
  if (watching() && action) note(source_of::sigaction, "sigaction", Digits(number), __builtin_return_address(0));
  return next_sigaction.get()(number, action, before);
}
// SIGSYS is never blocked: it reports system calls, and the kernel ends a process that blocks it.
#define REHEARSE_MASKED(name)                                                        \
  REHEARSE_INTERPOSED(int, name, (int how, const sigset_t* set, sigset_t* before)) { \
    if (!watching() || !set) return next_##name.get()(how, set, before);             \
    note(source_of::name, #name, "", __builtin_return_address(0));                   \
    sigset_t others = *set;                                                          \
    if (how != SIG_UNBLOCK) sigdelset(&others, SIGSYS);                              \
    return next_##name.get()(how, &others, before);                                  \
  }
REHEARSE_MASKED(sigprocmask)
REHEARSE_MASKED(pthread_sigmask)
#undef REHEARSE_MASKED

}  // namespace rehearse::interposer
