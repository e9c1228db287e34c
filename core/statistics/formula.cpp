#include "core/statistics/formula.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace homolog {

namespace {

constexpr std::array<std::pair<std::string_view, Variable::By>, 3> functions{
    {{"log", Variable::By::log}, {"sqrt", Variable::By::sqrt}, {"factor", Variable::By::factor}}};
constexpr std::string_view signs = "~+*:()";
constexpr const char* subject = "--formula";

struct Token {
  std::string text;
  bool is_name = false;
};

Result<std::vector<Token>> tokens_of(const std::string& text) {
  std::vector<Token> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == ' ' || c == '\t') {
      ++at;
    } else if (signs.find(c) != signs.npos) {
      tokens.push_back({std::string(1, c), false});
      ++at;
    } else if (c == '`') {
      const std::size_t end = text.find('`', at + 1);
      if (end == text.npos) return fail(subject, "has a backquote without its partner");
      tokens.push_back({text.substr(at + 1, end - at - 1), true});
      at = end + 1;
    } else if (std::string_view("-^/|%!=<>&,").find(c) != std::string_view::npos) {
      return fail(subject, std::string("has the sign \"") + c +
                               "\", which means nothing here; use + : * log() sqrt() factor(), and `…` around a name");
    } else {
      const std::size_t end = std::min(text.find_first_of(" \t`~+*:()-^/|%!=<>&,", at), text.size());
      tokens.push_back({text.substr(at, end - at), true});
      at = end;
    }
  }
  return tokens;
}

/// Takes tokens one after the other.
class Reader {
 public:
  explicit Reader(std::vector<Token> tokens) : tokens_(std::move(tokens)) {}
  bool at_end() const { return at_ == tokens_.size(); }
  bool take(std::string_view sign) {
    if (at_end() || tokens_[at_].is_name || tokens_[at_].text != sign) return false;
    ++at_;
    return true;
  }
  Result<Variable> variable() {
    if (at_end() || !tokens_[at_].is_name)
      return fail(subject, "lacks a name " + (at_end() ? "at its end" : "before " + tokens_[at_].text));
    const std::string word = tokens_[at_++].text;
    if (!take("(")) return Variable{Variable::By::itself, word};
    const auto* const known =
        std::find_if(functions.begin(), functions.end(), [&](const auto& one) { return one.first == word; });
    if (known == functions.end())
      return fail(subject, "has the function " + word + ", which is not known; use log, sqrt or factor");
    if (at_end() || !tokens_[at_].is_name) return fail(subject, word + "() needs the name of a column");
    Variable of{known->second, tokens_[at_++].text};
    if (!take(")")) return fail(subject, "lacks a ) after " + of.name);
    return of;
  }
  const std::string& next() const { return tokens_[at_].text; }

 private:
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
};

bool holds(const FormulaTerm& term, const Variable& variable) {
  return std::find(term.begin(), term.end(), variable) != term.end();
}
bool is_within(const FormulaTerm& part, const FormulaTerm& whole) {
  return std::all_of(part.begin(), part.end(), [&](const Variable& one) { return holds(whole, one); });
}

void add_once(std::vector<FormulaTerm>& terms, const FormulaTerm& term) {
  const bool known = std::any_of(terms.begin(), terms.end(), [&](const FormulaTerm& other) {
    return other.size() == term.size() && is_within(term, other);
  });
  if (!known) terms.push_back(term);
}

/// a*b*c: every interaction of some of the factors; each factor is a term itself.
Result<void> read_product(Reader& reader, std::vector<FormulaTerm>& terms) {
  std::vector<FormulaTerm> products{{}};
  do {
    FormulaTerm factor;
    do {
      auto variable = reader.variable();
      if (!variable) return fail(variable.error());
      if (!holds(factor, *variable)) factor.push_back(std::move(*variable));
    } while (reader.take(":"));
    const std::size_t before = products.size();
    for (std::size_t k = 0; k < before; ++k) {
      FormulaTerm joined = products[k];
      for (const Variable& one : factor)
        if (!holds(joined, one)) joined.push_back(one);
      products.push_back(std::move(joined));
    }
  } while (reader.take("*"));
  for (const FormulaTerm& one : products)
    if (!one.empty() && !(one.size() == 1 && one.front().text() == "1")) add_once(terms, one);
  return {};
}

Result<void> check_sides(const Formula& formula) {
  for (const FormulaTerm& term : formula.terms)
    for (const Variable& one : term)
      if (one.name == formula.response.name)
        return fail(subject, "has " + one.name + " on both sides of the ~; a variable cannot explain itself");
  return {};
}

/// Sums of the second kind need the main effects beside an interaction.
Result<void> check_marginal(const std::vector<FormulaTerm>& terms) {
  for (const FormulaTerm& term : terms)
    for (const Variable& one : term)
      if (std::find(terms.begin(), terms.end(), FormulaTerm{one}) == terms.end())
        return fail(subject,
                    text_of(term) + " needs " + one.text() + " as a term of its own; write a*b for a + b + a:b");
  return {};
}

}  // namespace

std::string Variable::text() const {
  for (const auto& [word, function] : functions)
    if (by == function) return std::string(word) + "(" + name + ")";
  return name;
}

std::string text_of(const FormulaTerm& term) {
  std::string text;
  for (const Variable& one : term) text += (text.empty() ? "" : ":") + one.text();
  return text;
}

Result<Formula> read_formula(const std::string& text) {
  auto tokens = tokens_of(text);
  if (!tokens) return fail(tokens.error());
  Reader reader(std::move(*tokens));
  Formula formula;
  auto response = reader.variable();
  if (!response) return fail(response.error());
  formula.response = std::move(*response);
  if (!reader.take("~"))
    return fail(subject, "lacks a ~ after " + formula.response.text() + "; write \"shape ~ group\"");
  do {
    if (auto read = read_product(reader, formula.terms); !read) return fail(read.error());
  } while (reader.take("+"));
  if (!reader.at_end()) return fail(subject, "cannot be read from " + reader.next() + " on; put + between terms");
  if (formula.terms.empty()) return fail(subject, "has no term to test; write \"shape ~ group\"");
  if (auto sides = check_sides(formula); !sides) return fail(sides.error());
  if (auto complete = check_marginal(formula.terms); !complete) return fail(complete.error());
  std::stable_sort(formula.terms.begin(), formula.terms.end(),
                   [](const FormulaTerm& a, const FormulaTerm& b) { return a.size() < b.size(); });
  return formula;
}

}  // namespace homolog
