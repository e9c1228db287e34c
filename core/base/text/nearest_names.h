#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace homolog {

/// Those of the names that a word was most likely meant as, at most `most`, the likeliest first: with fewest letters
/// changed, left out, put in or exchanged; before all those that hold the whole word. Letters in lower and
/// upper case are alike.
std::vector<std::string> nearest_names(const std::string& word, std::vector<std::string> names, std::size_t most);

}  // namespace homolog
