#include "core/volume/dicom/dicom_text.h"

#include <algorithm>
#include <array>

#include "core/base/text/system_text.h"
#include "core/base/text/text.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

namespace {

constexpr char escape = '\x1b';

/// An alphabet: the number by which files name it, the escape that begins it (without ESC), and the encoding in which
/// its letters lie, as iconv calls it. `pairs`: letters of two bytes. `low`: they have no upper bit, as ASCII.
struct Alphabet {
  std::string_view number, begin;
  const char* encoding;
  bool pairs = false, low = false;
};

constexpr std::array<Alphabet, 18> alphabets{{{"6", "(B", "ASCII", false, true},
                                              {"14", "(J", "ASCII", false, true},
                                              {"100", "-A", "ISO-8859-1"},
                                              {"101", "-B", "ISO-8859-2"},
                                              {"109", "-C", "ISO-8859-3"},
                                              {"110", "-D", "ISO-8859-4"},
                                              {"144", "-L", "ISO-8859-5"},
                                              {"127", "-G", "ISO-8859-6"},
                                              {"126", "-F", "ISO-8859-7"},
                                              {"138", "-H", "ISO-8859-8"},
                                              {"148", "-M", "ISO-8859-9"},
                                              {"166", "-T", "TIS-620"},
                                              {"203", "-b", "ISO-8859-15"},
                                              // EUC-JP: a letter of half width lies behind the byte 8e.
                                              {"13", ")I", "EUC-JP"},
                                              {"87", "$B", "EUC-JP", true, true},
                                              // EUC-JP too, behind the byte 8f.
                                              {"159", "$(D", "EUC-JP", true, true},
                                              {"149", "$)C", "EUC-KR", true},
                                              {"58", "$)A", "GB2312", true}}};

/// "ISO_IR 144" and "ISO 2022 IR 144" name one alphabet; null for "", of which ASCII is the default.
const Alphabet* alphabet_named(std::string_view name) {
  for (const std::string_view begin : {std::string_view("ISO_IR "), std::string_view("ISO 2022 IR ")})
    if (name.starts_with(begin))
      for (const Alphabet& one : alphabets)
        if (one.number == name.substr(begin.size())) return &one;
  return nullptr;
}

bool is_plain(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80 && c != escape; });
}

/// Letters of one alphabet as UTF-8.
std::optional<std::string> letters_of(std::string_view bytes, const Alphabet& alphabet) {
  std::string euc;
  const bool half_width = alphabet.number == "13", third = alphabet.number == "159";
  if (alphabet.pairs && bytes.size() % 2 != 0) return std::nullopt;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    if (half_width) euc += '\x8e';
    if (third && k % 2 == 0) euc += '\x8f';
    euc += alphabet.low ? static_cast<char>(static_cast<unsigned char>(bytes[k]) | 0x80) : bytes[k];
  }
  return utf8_of(euc, alphabet.encoding);
}

/// A text with letters of several alphabets, which escapes begin [DICOM PS3.5, 6.1.2.5].
std::optional<std::string> with_escapes(std::string_view text, const Alphabet* high) {
  const Alphabet* low = nullptr;  // ASCII
  std::string result;
  while (!text.empty()) {
    if (text.front() == escape) {
      const auto begun =
          std::ranges::find_if(alphabets, [&](const Alphabet& one) { return text.substr(1).starts_with(one.begin); });
      if (begun == alphabets.end()) return std::nullopt;
      (begun->low ? low : high) = begun->low && !begun->pairs ? nullptr : &*begun;
      text.remove_prefix(1 + begun->begin.size());
      continue;
    }
    const auto is_high = [](char c) { return static_cast<unsigned char>(c) >= 0x80; };
    const bool of_high = is_high(text.front());
    const auto end = std::ranges::find_if(text, [&](char c) { return c == escape || is_high(c) != of_high; });
    const auto run = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    const Alphabet* alphabet = of_high ? high : low;
    if (of_high && alphabet == nullptr) return std::nullopt;
    const auto letters = alphabet == nullptr ? std::optional(std::string(run)) : letters_of(run, *alphabet);
    if (!letters) return std::nullopt;
    result += *letters;
    text.remove_prefix(run.size());
  }
  return result;
}

}  // namespace

DicomAlphabets::DicomAlphabets(const DicomItem& data) : words_(text_of(data, 0x00080005)) {
  for (std::string_view rest = words_;;) {
    const auto end = std::min(rest.find('\\'), rest.size());
    names_.emplace_back(trimmed(rest.substr(0, end)));
    if (end == rest.size()) return;
    rest.remove_prefix(end + 1);
  }
}

std::optional<std::string> DicomAlphabets::read(const std::string& text) const {
  const std::string& first = names_.front();
  const bool lenient = first.empty() || first == "ISO_IR 6" || first == "ISO 2022 IR 6" || first == "ISO_IR 100" ||
                       first == "ISO 2022 IR 100" || first == "ISO_IR 192";
  const bool escapes = text.find(escape) != text.npos;
  if (is_plain(text) || first == "ISO_IR 192" || (lenient && !escapes)) return segment_name(text);
  std::optional<std::string> decoded;
  if (first == "GB18030" || first == "GBK")
    decoded = utf8_of(text, first.c_str());
  else
    decoded = with_escapes(text, alphabet_named(first));
  if (!decoded) return std::nullopt;
  return segment_name(*decoded);
}

std::string DicomAlphabets::name_of(const DicomItem& item, DicomTag tag, bool& unread) const {
  std::string text = text_of(item, tag);
  if (auto name = read(text)) return std::move(*name);
  unread = true;
  for (char& c : text)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  return segment_name(text);
}

std::string unread_names(const std::string& path, const DicomAlphabets& alphabets) {
  return path + ": has names in letters that cannot be read (its character set is " + excerpt(alphabets.words()) +
         "), each of which is shown as a question mark; choose structures by their numbers";
}

}  // namespace homolog
