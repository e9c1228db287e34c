#include "core/statistics/permutations.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/numbers/random.h"
#include "core/base/text/text.h"

namespace homolog {

namespace {

/// Fisher–Yates over the places of one block.
void shuffle(const std::vector<int>& places, Permutations& all, Eigen::Index row, Random& random) {
  for (std::size_t left = places.size(); left > 1; --left) {
    const auto other = std::min(left - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(left)));
    std::swap(all(row, places[left - 1]), all(row, places[other]));
  }
}

Result<std::vector<int>> read_line(std::string_view line, Eigen::Index cases, const std::string& where,
                                   const std::string& source) {
  std::vector<int> numbers;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r,;", at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r,;", at), line.size());
    const auto number = as_number<int>(line.substr(at, end - at));
    if (!number) return fail(source, where + " has \"" + excerpt(line.substr(at, end - at)) + "\", which is no number");
    numbers.push_back(*number);
    at = end;
  }
  if (static_cast<Eigen::Index>(numbers.size()) != cases)
    return fail(source, where + " has " + std::to_string(numbers.size()) + " numbers where " + std::to_string(cases) +
                            " cases are tested");
  std::vector<bool> seen(numbers.size());
  for (const int number : numbers) {
    if (number < 0 || number >= cases || seen[number])
      return fail(source, where + " is no permutation: it has to hold each number from 0 to " +
                              std::to_string(cases - 1) + " once");
    seen[number] = true;
  }
  return numbers;
}

}  // namespace

Eigen::VectorXd taken_along(const Eigen::VectorXd& values, const Permutations& permutations, Eigen::Index row) {
  Eigen::VectorXd moved(values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) moved[i] = values[permutations(row, i)];
  return moved;
}

Permutations random_permutations(const std::vector<int>& blocks, Eigen::Index count, std::uint64_t seed) {
  std::map<int, std::vector<int>> places;
  for (std::size_t i = 0; i < blocks.size(); ++i) places[blocks[i]].push_back(static_cast<int>(i));
  Permutations all(count, static_cast<Eigen::Index>(blocks.size()));
  Random random(seed);
  for (Eigen::Index row = 0; row < count; ++row) {
    std::iota(all.row(row).begin(), all.row(row).end(), 0);
    for (const auto& [block, of_block] : places) shuffle(of_block, all, row, random);
  }
  return all;
}

double different_orders(const std::vector<int>& blocks, const Eigen::MatrixXd& design) {
  std::map<int, std::map<std::vector<double>, int>> kinds;  // for each block: rows and how many cases have them
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Eigen::RowVectorXd row = design.row(static_cast<Eigen::Index>(i));
    ++kinds[blocks[i]][std::vector<double>(row.begin(), row.end())];
  }
  double orders = 1;
  bool exchange = true;
  for (const auto& [block, of_block] : kinds) {
    exchange = exchange && of_block.size() == 2 && of_block.begin()->second == of_block.rbegin()->second;
    int placed = 0;
    for (const auto& [row, count] : of_block)  // n! ÷ ∏ counts!, one factor at a time
      for (int k = 1; k <= count; ++k) orders *= static_cast<double>(++placed) / k;
  }
  return exchange ? orders / 2 : orders;
}

Result<Permutations> read_permutations(const std::filesystem::path& path, Eigen::Index cases) {
  const auto text = read_whole_file(path, std::uintmax_t{1} << 30);
  if (!text) return fail(text.error());
  std::vector<int> all;
  Eigen::Index rows = 0, number = 0;
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    const std::string_view line = std::string_view(*text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (trimmed(line).empty()) continue;
    const auto read = read_line(line, cases, "line " + std::to_string(number), path.string());
    if (!read) return fail(read.error());
    all.insert(all.end(), read->begin(), read->end());
    ++rows;
  }
  if (rows == 0) return fail(path.string(), "has no permutations; give one a line");
  return Permutations(Eigen::Map<const Permutations>(all.data(), rows, cases));
}

}  // namespace homolog
