#include "core/session/line_kind.h"

#include <algorithm>
#include <cstring>

#include "core/case/action_json.h"

namespace homolog {

namespace {

/// Goes through the members of one JSON object, without looking into their values.
class Members {
 public:
  explicit Members(std::string_view text) : rest_(text) { skip_space(); }

  bool begins() { return take('{'); }
  bool ends() { return take('}') && rest_.empty(); }
  /// The next member; false where there is none, or something else.
  bool next(std::string_view& key, std::string_view& value) {
    take(',');
    if (!take_string(key) || key.find('\\') != std::string_view::npos || !take(':')) return false;
    return take_value(value);
  }

 private:
  void skip_space() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t' || rest_.front() == '\r'))
      rest_.remove_prefix(1);
  }
  bool take(char wanted) {
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    skip_space();
    return true;
  }
  /// Past the quotation mark that ends a string which began before `from`; 0 where none does.
  std::size_t end_of_string(std::size_t from) const {
    for (;;) {
      const void* found = std::memchr(rest_.data() + from, '"', rest_.size() - from);
      if (found == nullptr) return 0;
      const auto end = static_cast<std::size_t>(static_cast<const char*>(found) - rest_.data());
      std::size_t escapes = 0;
      while (rest_[end - 1 - escapes] == '\\') ++escapes;  // stops at the opening mark at the latest
      if (escapes % 2 == 0) return end + 1;
      from = end + 1;
    }
  }
  bool take_string(std::string_view& inside) {
    if (rest_.empty() || rest_.front() != '"') return false;
    const std::size_t end = end_of_string(1);
    if (end == 0) return false;
    inside = rest_.substr(1, end - 2);
    rest_.remove_prefix(end);
    skip_space();
    return true;
  }
  bool take_value(std::string_view& value) {
    const std::string_view whole = rest_;
    if (std::string_view inside; take_string(inside)) {
      value = whole.substr(0, inside.size() + 2);
      return true;
    }
    std::size_t end = 0;
    for (int depth = 0; end < rest_.size(); ++end) {
      const char c = rest_[end];
      if (c == '"') {
        const std::size_t past = end_of_string(end + 1);
        if (past == 0) return false;
        end = past - 1;
      } else if (c == '{' || c == '[') {
        ++depth;
      } else if (c == '}' || c == ']' || c == ',') {
        if (depth == 0) break;
        if (c != ',') --depth;
      }
    }
    value = rest_.substr(0, end);
    while (!value.empty() && value.back() == ' ') value.remove_suffix(1);
    rest_.remove_prefix(end);
    skip_space();
    return !value.empty();
  }

  std::string_view rest_;
};

LineKind::Kind kind_of_role(LineRole role) {
  switch (role) {
    case LineRole::note:
      return LineKind::note;
    case LineRole::undo:
      return LineKind::undo;
    case LineRole::redo:
      return LineKind::redo;
    default:
      return LineKind::step;
  }
}

}  // namespace

LineKind kind_of(std::string_view line) {
  Members members(line);
  if (!members.begins())
    return {line.find_first_not_of(" \t\r") == std::string_view::npos ? LineKind::empty : LineKind::unknown};
  LineKind found;
  bool says_look = false, can_look = false;
  int steps = 0;
  LineKind::Kind other = LineKind::unknown;  // the kind of what is no step; the first in this order decides
  for (std::string_view key, value; members.next(key, value);) {
    if (key == "joined") found.joined = value == "true";
    if (key == "look") says_look = value == "true";
    if (key == "window" || key == "template_file" || key == "fit" || key == "looks" || key == "map_fit")
      found.keeps = true;
    if (key == "checkpoint") other = std::min(other, LineKind::checkpoint);
    const auto role = role_of_key(key);
    if (!role) continue;
    if (const auto kind = kind_of_role(*role); kind != LineKind::step)
      other = std::min(other, kind);
    else
      ++steps;
    found.stroke = found.stroke || *role == LineRole::stroke;
    can_look = can_look || *role == LineRole::step_or_look;
  }
  if (!members.ends()) return {};
  if (steps == 0)
    found.kind = other;
  else
    found.kind = says_look && can_look && steps == 1 ? LineKind::look : LineKind::step;
  found.keeps = found.keeps && found.kind == LineKind::note;
  return found;
}

}  // namespace homolog
