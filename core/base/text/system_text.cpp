#include "core/base/text/system_text.h"

#include <iconv.h>

#include <array>
#include <cerrno>
#include <cstdint>

namespace homolog {

std::optional<std::string> utf8_of(std::string_view text, const char* encoding) {
  const iconv_t converter = ::iconv_open("UTF-8", encoding);
  if (reinterpret_cast<std::intptr_t>(converter) == -1) return std::nullopt;
  std::string result, in(text);  // iconv takes no constant text
  char* from = in.data();
  std::size_t left = in.size();
  bool fine = true;
  while (fine && left > 0) {
    std::array<char, 256> part;
    char* to = part.data();
    std::size_t room = part.size();
    fine = ::iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1) || errno == E2BIG;
    result.append(part.data(), part.size() - room);
  }
  ::iconv_close(converter);
  return fine ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace homolog
