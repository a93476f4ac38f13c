#include "settings.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

namespace rehearse::interposer {
namespace {

[[noreturn]] void refuse(const char* setting) {
  dprintf(STDERR_FILENO, "rehearse_interposer: unknown setting '%s' in REHEARSE_INTERPOSER\n", setting);
  _exit(2);
}

/// Decodes the digits of %3b and similar codes; copies other text.
void unescape(const char* text, char* to, size_t size) {
  size_t length = 0;
  for (; *text && length + 1 < size; ++text) {
    if (*text == '%' && isxdigit(text[1]) && isxdigit(text[2])) {
      const char digits[] = {text[1], text[2], 0};
      to[length++] = static_cast<char>(strtoul(digits, nullptr, 16));
      text += 2;
    } else {
      to[length++] = *text;
    }
  }
  to[length] = 0;
}

bool read_substitution(const char* name, const char* value, Substitution& substitution) {
  if (strncmp(name, "clock.", 6) == 0) substitution.has_clock = true;
  if (strcmp(name, "clock.date") == 0)
    substitution.date = strtoll(value, nullptr, 10);
  else if (strcmp(name, "clock.uptime") == 0)
    substitution.uptime = strtoll(value, nullptr, 10);
  else if (strcmp(name, "clock.rate") == 0)
    substitution.rate = strtoll(value, nullptr, 10);
  else if (strcmp(name, "clock.read_step") == 0)
    substitution.read_step = strtoll(value, nullptr, 10);
  else if (strcmp(name, "seed") == 0)
    substitution.has_seed = true, substitution.seed = strtoull(value, nullptr, 10);
  else if (strcmp(name, "machine") == 0)
    substitution.machine = static_cast<int>(strtol(value, nullptr, 10));
  else if (strcmp(name, "threads") == 0)
    substitution.threads = strcmp(value, "late") == 0 ? Threads::late : Threads::early;
  else if (strcmp(name, "slow") == 0)
    substitution.slow = static_cast<int>(strtol(value, nullptr, 10));
  else
    return false;
  return true;
}

void read_setting(char* setting, Settings& settings) {
  char* value = strchr(setting, '=');
  if (!value) refuse(setting);
  *value++ = 0;
  if (strcmp(setting, "log") == 0) {
    unescape(value, settings.log, sizeof settings.log);
  } else if (strcmp(setting, "files") == 0) {
    unescape(value, settings.files, sizeof settings.files);
  } else if (strcmp(setting, "only") == 0) {
    char* offset = strrchr(value, '+');
    if (!offset) refuse(value);
    *offset++ = 0;
    settings.has_only = true;
    settings.only_offset = strtoull(offset, nullptr, 16);
    unescape(value, settings.only_module, sizeof settings.only_module);
  } else {
    const bool is_there = strncmp(setting, "there.", 6) == 0;
    if (!read_substitution(setting + (is_there ? 6 : 0), value, is_there ? settings.there : settings.everywhere))
      refuse(setting);
  }
}

}  // namespace

void read_settings(const char* text, Settings& settings) {
  settings.there.layer = 1;
  char* copy = strdup(text);
  char* rest = copy;
  while (char* setting = strsep(&rest, ";"))
    if (*setting) read_setting(setting, settings);
  free(copy);
}

}  // namespace rehearse::interposer
