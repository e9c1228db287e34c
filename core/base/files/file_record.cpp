#include "core/base/files/file_record.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/files/open_file.h"
#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t piece_bytes = 200;
/// A header with its record is never longer: a record names some hundred bytes for each input.
constexpr std::size_t most_header_bytes = std::size_t{16} << 20;

constexpr const char* case_ending = ".homolog";

/// A record as it is written: one line of ASCII.
std::string line_of(const nlohmann::ordered_json& record) {
  return record.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

/// The key of a case's first line, which is JSON.
std::string from_case(std::string_view text) {
  const auto header = read_json<nlohmann::ordered_json>(text.substr(0, text.find('\n')));
  if (!header || !header->is_object() || !header->contains(record_key)) return {};
  return line_of((*header)[record_key]);
}

/// The pieces of all lines, joined.
std::string joined_lines(std::string_view text) {
  const std::string key = std::string(record_key) + " ";
  std::string record;
  for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    const std::size_t line = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
    const std::string_view begin = text.substr(line, at - line);
    if (begin != "comment " && begin != "# ") continue;
    const std::size_t from = at + key.size(), end = std::min(text.find('\n', from), text.size());
    std::string_view piece = text.substr(from, end - from);
    if (piece.ends_with('\r')) piece.remove_suffix(1);
    record += piece;
  }
  return record;
}

std::string from_nrrd(std::string_view text) {
  const std::string key = "\n" + std::string(record_key) + ":=";
  const std::size_t at = text.find(key);
  if (at == text.npos || at > text.find("\n\n")) return {};
  std::string record;
  for (std::size_t k = at + key.size(); k < text.size() && text[k] != '\n' && text[k] != '\r'; ++k) {
    if (text[k] == '\\' && k + 1 < text.size()) ++k;
    record += text[k];
  }
  return record;
}

std::string from_vtk(std::string_view text) {
  const std::string key = "\n" + std::string(record_key) + " 1 ";
  const std::size_t at = text.find(key);
  if (at == text.npos) return {};
  const std::size_t number = at + key.size(), blank = text.find(' ', number), line = text.find('\n', number);
  if (blank == text.npos || line == text.npos || blank > line) return {};
  const auto bytes = as_number<std::size_t>(text.substr(number, blank - number));
  return bytes && *bytes <= text.size() - line - 1 ? std::string(text.substr(line + 1, *bytes)) : std::string();
}

std::string from_vtp(std::string_view text) {
  const std::size_t at = text.find("Name=\"" + std::string(record_key) + "\"");
  const std::size_t open = at == text.npos ? at : text.find('>', at);
  const std::size_t close = open == text.npos ? open : text.find('<', open);
  if (close == text.npos) return {};
  std::string record;
  std::string_view codes = trimmed(text.substr(open + 1, close - open - 1));
  while (!codes.empty()) {
    const std::size_t end = std::min(codes.find_first_of(" \n\t\r"), codes.size());
    const auto code = as_number<std::uint8_t>(codes.substr(0, end));
    if (!code) return {};
    if (*code != 0) record += static_cast<char>(*code);
    codes = trimmed(codes.substr(end));
  }
  return record;
}

/// A number as PNG has it: the highest byte first.
std::string four_bytes(std::size_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

std::size_t number_at(std::string_view bytes, std::size_t at) {
  std::size_t number = 0;
  for (std::size_t k = 0; k < 4 && at + k < bytes.size(); ++k)
    number = number << 8 | static_cast<unsigned char>(bytes[at + k]);
  return number;
}

constexpr std::string_view png_start = "\x89PNG\r\n\x1a\n";
/// Signature and first chunk; PNG wants that chunk first.
constexpr std::size_t png_text_at = 33;

/// A chunk of text with its key.
std::string png_chunk(std::string_view record) {
  std::string chunk = "tEXt" + std::string(record_key) + '\0' + std::string(record);
  const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
  return four_bytes(chunk.size() - 4) + chunk + four_bytes(sum);
}

/// The record's place in a file; empty where there is none.
struct Place {
  std::size_t from = 0, size = 0;    ///< the record's place
  std::size_t begin = 0, whole = 0;  ///< the place of what holds it
};

Place place_in_png(std::string_view bytes) {
  const std::string key = "tEXt" + std::string(record_key) + '\0';
  constexpr std::size_t at = png_text_at, numbers = 8;  // length and sum
  if (!bytes.starts_with(png_start) || bytes.size() < at + numbers) return {};
  const std::size_t size = number_at(bytes, at);
  if (bytes.substr(at + 4, key.size()) != key || size + 4 < key.size() || bytes.size() < at + numbers + 4 + size)
    return {};
  return {at + 4 + key.size(), size + 4 - key.size(), at, size + numbers + 4};
}

/// How a text format holds a record: behind the first `after`, between `begin` and `end`.
struct RecordInText {
  std::string_view ending, after, begin, end;
};

constexpr std::array record_in_text{
    RecordInText{".svg", "<svg", "<metadata id=\"homolog.record\">", "</metadata>\n"},
    RecordInText{".html", "<head>", "\n<script type=\"application/json\" id=\"homolog.record\">", "</script>"},
    RecordInText{".htm", "<head>", "\n<script type=\"application/json\" id=\"homolog.record\">", "</script>"},
    RecordInText{".json", "{", "\n  \"homolog.record\": ", ","},
};

bool is_png_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".png";
}

const RecordInText* form_of(const fs::path& path) {
  const auto form = std::ranges::find(record_in_text, lower_case(path.extension().string()), &RecordInText::ending);
  return form == record_in_text.end() ? nullptr : &*form;
}

/// Angle brackets would end what they stand in; JSON may escape them.
std::string without_brackets(std::string_view record) {
  std::string text;
  for (const char c : record)
    text += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : c == '&' ? "\\u0026" : std::string(1, c);
  return text;
}

Place place_in_text(const RecordInText& form, std::string_view text) {
  const std::size_t at = text.find(form.begin);
  if (at == text.npos) return {};
  const std::size_t from = at + form.begin.size(), line = std::min(text.find('\n', from), text.size() - 1);
  const std::size_t end = text.substr(0, line + 1).rfind(form.end);
  return end == text.npos || end < from ? Place() : Place{from, end - from, at, end + form.end.size() - at};
}

Place place_in(const fs::path& path, std::string_view bytes) {
  if (const RecordInText* form = form_of(path)) return place_in_text(*form, bytes);
  return is_png_name(path) ? place_in_png(bytes) : Place();
}

/// The begin of a file, where headers are.
Result<std::string> header_bytes(const fs::path& path) {
  if (const auto size = size_of_file(path); !size) return fail(size.error());
  const auto file = OpenFile::open(path, OpenFile::For::reading);
  if (!file) return fail(path.string(), "cannot be read; check its rights");
  std::string bytes(most_header_bytes, '\0');
  std::size_t have = 0;
  while (have < bytes.size()) {
    const auto got = file->read_at(bytes.data() + have, bytes.size() - have, have);
    if (!got) return fail(path.string(), "cannot be read to its end; copy it again");
    if (*got == 0) break;
    have += *got;
  }
  bytes.resize(have);
  return bytes;
}

}  // namespace

std::string record_lines(std::string_view begin, std::string_view record) {
  std::string lines;
  for (std::size_t at = 0; at < record.size(); at += piece_bytes)
    lines.append(begin).append(record_key).append(" ").append(record.substr(at, piece_bytes)).append("\n");
  return lines;
}

bool is_record_line(std::string_view line) {
  return line.starts_with(record_key) && line.substr(record_key.size()).starts_with(' ');
}

std::string record_of_nrrd(std::string_view record) {
  if (record.empty()) return {};
  std::string line = "\n" + std::string(record_key) + ":=";
  for (const char c : record) line += c == '\\' ? std::string("\\\\") : std::string(1, c);
  return line;
}

std::string record_of_vtk(std::string_view record) {
  if (record.empty()) return {};
  return "FIELD FieldData 1\n" + std::string(record_key) + " 1 " + std::to_string(record.size()) + " unsigned_char\n" +
         std::string(record) + "\n";
}

std::string record_of_vtp(std::string_view record) {
  if (record.empty()) return {};
  std::string codes;
  for (const char c : record) codes += std::to_string(static_cast<unsigned char>(c)) + " ";
  return "<DataArray type=\"String\" Name=\"" + std::string(record_key) + "\" NumberOfTuples=\"1\" format=\"ascii\">" +
         codes + "0</DataArray>\n";
}

Result<std::string> with_record(const fs::path& path, std::string bytes, std::string_view record) {
  bytes = without_record(path, std::move(bytes));
  if (record.empty()) return bytes;
  const RecordInText* form = form_of(path);
  if (is_png_name(path) && bytes.starts_with(png_start) && bytes.size() > png_text_at)
    return bytes.insert(png_text_at, png_chunk(record));
  std::size_t at = form == nullptr ? bytes.npos : bytes.find(form->after);
  if (at != bytes.npos) at += form->after.size();
  if (at != bytes.npos && form->after.starts_with('<') && !form->after.ends_with('>')) at = bytes.find('>', at) + 1;
  if (at == bytes.npos || at == 0) return fail(path.string(), "was changed by another program while it was written");
  return bytes.insert(at, std::string(form->begin) + without_brackets(record) + std::string(form->end));
}

Result<void> add_record(const fs::path& path, std::string_view record) {
  if (form_of(path) == nullptr && !is_png_name(path)) return write_record_file(path, record);
  auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  const auto whole = with_record(path, std::move(*bytes), record);
  return whole ? write_whole_file(path, *whole) : fail(whole.error());
}

std::string without_record(const fs::path& path, std::string bytes) {
  const Place place = place_in(path, bytes);
  return bytes.erase(place.begin, place.whole);
}

bool is_record_file(const fs::path& path) {
  return path.filename().string().ends_with(record_extension);
}

fs::path record_file_of(const fs::path& path) {
  return path.parent_path() / (path.filename().string() + record_extension);
}

Result<void> write_record_file(const fs::path& path, std::string_view record) {
  const fs::path beside = record_file_of(path);
  if (record.empty()) {
    std::error_code ignored;  // most files have none
    fs::remove(beside, ignored);
    return {};
  }
  const auto json = read_json<nlohmann::ordered_json>(record);
  if (!json) return fail(beside.string(), json.error().what + "; give inputs shorter names");
  return write_whole_file(beside, nlohmann::ordered_json{{std::string(record_key), *json}}.dump(1) + "\n");
}

Result<std::optional<std::string>> read_record(const fs::path& path) {
  const auto header = header_bytes(path);
  if (!header) return fail(header.error());
  const std::string extension = lower_case(path.extension().string());
  std::string record;
  if (extension == ".ply" || extension == ".obj" || extension == ".msh") record = joined_lines(*header);
  if (extension == ".nrrd") record = from_nrrd(*header);
  if (extension == ".vtk") record = from_vtk(*header);
  if (extension == ".vtp" || extension == ".vtu") record = from_vtp(*header);
  if (extension == case_ending) record = from_case(*header);
  if (const Place place = place_in(path, *header); place.size > 0) record = header->substr(place.from, place.size);
  if (!record.empty()) return record;
  const fs::path beside = record_file_of(path);
  if (std::error_code none; !fs::exists(beside, none)) return std::nullopt;
  const auto text = read_whole_file(beside, most_header_bytes);
  if (!text) return fail(text.error());
  const auto json = read_json<nlohmann::ordered_json>(*text);
  if (!json) return fail(beside.string(), json.error().what + "; copy it again with its file");
  if (!json->is_object() || !json->contains(std::string(record_key))) return std::nullopt;
  return line_of((*json)[std::string(record_key)]);
}

}  // namespace homolog
