#include "small_page.h"

#include <fmt/format.h>

#include "html_text.h"

namespace rehearse {
namespace {

constexpr std::string_view help = R"(<dialog class="help" aria-labelledby="help-title">
<h2 id="help-title">Keys</h2>
<table><tbody>
<tr><th scope="row"><kbd>n</kbd></th><td>the next finding</td></tr>
<tr><th scope="row"><kbd>p</kbd></th><td>the previous finding</td></tr>
<tr><th scope="row"><kbd>/</kbd></th><td>search</td></tr>
<tr><th scope="row"><kbd>t</kbd></th><td>light or dark</td></tr>
<tr><th scope="row"><kbd>?</kbd></th><td>this help</td></tr>
</tbody></table>
<button type="button" id="close">Close</button>
</dialog>)";

}  // namespace

std::string small_page(const SmallPage& page) {
  std::string text = fmt::format(
      "{}\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<style>\n",
      page.magic, html_text(page.title));
  text.append(small_page_style()).append("</style>\n<script>\n").append(small_page_script());
  text += fmt::format(
      "</script>\n</head><body>\n<header class=\"top\"><div class=\"verdict {}\"><div class=\"heading\">\n"
      "<span class=\"state\">{}</span>\n<h1>{}</h1>\n<div class=\"corner\">"
      "<button type=\"button\" id=\"theme\" class=\"quiet\" title=\"Light or dark (t)\">Theme</button>"
      "<button type=\"button\" id=\"help\" class=\"quiet\" title=\"Keys and help (?)\" aria-label=\"Keys and help "
      "(?)\">?"
      "</button></div>\n</div>{}</div></header>\n<main>\n{}</main>\n{}\n</body></html>\n",
      page.is_bad ? "beyond" : "equal", html_text(page.kind), html_text(page.title),
      page.sentence.empty() ? "" : fmt::format("\n<p class=\"sentence\">{}</p>", html_text(page.sentence)),
      page.content, help);
  return text;
}

}  // namespace rehearse
