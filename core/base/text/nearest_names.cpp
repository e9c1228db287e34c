#include "core/base/text/nearest_names.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/text/text.h"

namespace homolog {

namespace {

/// Edit distance with exchanged neighbours, row by row.
std::size_t edit_distance(const std::string& word, const std::string& name) {
  std::vector<std::vector<std::size_t>> d(word.size() + 1, std::vector<std::size_t>(name.size() + 1));
  for (std::size_t i = 0; i <= word.size(); ++i) d[i][0] = i;
  std::iota(d[0].begin(), d[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= word.size(); ++i)
    for (std::size_t j = 1; j <= name.size(); ++j) {
      const std::size_t other = word[i - 1] == name[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + other});
      if (i > 1 && j > 1 && word[i - 1] == name[j - 2] && word[i - 2] == name[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[word.size()][name.size()];
}

}  // namespace

std::vector<std::string> nearest_names(const std::string& word, std::vector<std::string> names, std::size_t most) {
  constexpr std::size_t longest = 100;  // names come from files
  const std::string wanted = lower_case(word.substr(0, longest));
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (std::string& name : names) {
    const std::string known = lower_case(name.substr(0, longest));
    const bool held = wanted.size() > 1 && known.find(wanted) != known.npos;
    const std::size_t distance = held ? 0 : edit_distance(wanted, known);
    ranked.emplace_back(distance, std::move(name));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  names.clear();
  for (auto& [distance, name] : ranked)
    if (names.size() < most) names.push_back(std::move(name));
  return names;
}

}  // namespace homolog
