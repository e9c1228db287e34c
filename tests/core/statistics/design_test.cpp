#include "core/statistics/design.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "core/base/files/files.h"
#include "core/base/text/text_table.h"
#include "core/statistics/covariates.h"
#include "core/statistics/formula.h"
#include "core/statistics/permutations.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Formulas, tables and designs.

namespace homolog {

namespace {

std::string terms_of(const std::string& formula) {
  std::string words;
  for (const FormulaTerm& term : test::must(read_formula(formula)).terms)
    words += (words.empty() ? "" : " ") + text_of(term);
  return words;
}

CovariateTable table_of(const std::vector<std::string>& values) {
  CovariateTable table{"t.csv", {"x"}, {}, {}};
  for (const std::string& value : values) {
    table.cases.push_back("c" + std::to_string(table.cases.size()));
    table.cells.push_back({value});
  }
  return table;
}

const std::vector<std::size_t> first_four{0, 1, 2, 3};
const Variable x{Variable::By::itself, "x"};

}  // namespace

TEST_CASE("a formula is its terms with main effects before interactions and none twice") {
  CHECK(terms_of("shape ~ group + age + log(size)") == "group age log(size)");
  CHECK(terms_of("shape~a*b+a") == "a b a:b");
  CHECK(terms_of("shape ~ a:b + b + a + 1") == "b a a:b");
  CHECK(terms_of("shape ~ a*b*c") == "a b c a:b a:c b:c a:b:c");
  CHECK(terms_of("shape ~ `blood pressure` + factor(site)") == "blood pressure factor(site)");
  CHECK(test::must(read_formula("log(size) ~ age")).response == Variable{Variable::By::log, "size"});
}

TEST_CASE("a formula that cannot be read says where") {
  const std::array<std::pair<const char*, const char*>, 10> wrong{{{"shape", "lacks a ~"},
                                                                   {"shape ~", "lacks a name at its end"},
                                                                   {"~ a", "lacks a name before ~"},
                                                                   {"shape ~ a - b", "has the sign \"-\", which"},
                                                                   {"shape ~ exp(a)", "has the function exp"},
                                                                   {"shape ~ a + a:b", "a:b needs b as a term"},
                                                                   {"shape ~ 1", "has no term"},
                                                                   {"shape ~ a b", "cannot be read from b on"},
                                                                   {"age ~ shape + age", "both sides"},
                                                                   {"shape ~ `a", "backquote"}}};
  for (const auto& [formula, what] : wrong) CHECK(says(read_formula(formula), what));
}

TEST_CASE("a table is read with any separator and its errors name the line") {
  const TemporaryFolder folder;
  const auto file = folder.path / "t.csv";
  const auto read = [&](const std::string& text) {
    REQUIRE(write_whole_file(file, text));
    return read_covariates(file);
  };
  const CovariateTable table = test::must(read("age;Case;group\r\n41;k1;a b\r\n\r\n;k2;\"c;d\"\r\n"));
  CHECK(table.columns == std::vector<std::string>{"age", "group"});
  CHECK(table.cases == std::vector<std::string>{"k1", "k2"});
  CHECK(table.cells[1] == std::vector<std::string>{"", "c;d"});
  CHECK(table.column("group") == 1U);
  CHECK_FALSE(table.column("Case"));
  CHECK(says(read("name,age\nk1,4,5\n"), "line 2 has 3 cells"));
  CHECK(says(read(std::string("\xFF\xFE"
                              "n\0a\0",
                              6)),
             "UTF-16"));
  CHECK(says(read(std::string("PK\3\4a\0b\n", 8)), "is no text"));  // as a workbook
  CHECK(says(read("name,age\nk1,4\nk1,5\n"), "has the case k1 twice"));
  // The rows that measure --model adds are no cases; of other tables "model" is one.
  const CovariateTable modes = test::must(read("name,mode,sd,volume\nk1,,,4\nmodel,1,-2,5\nmodel,1,2,6\n"));
  CHECK(modes.cases == std::vector<std::string>{"k1"});
  CHECK(test::must(read("name,mode\nmodel,1\nk1,2\n")).cases.size() == 2);
  CHECK(says(read("name,age,age\nk1,4,4\n"), "has the column age twice"));
  CHECK(says(read("name,age\n,4\n"), "names no case"));
  CHECK(says(read("name,age\n"), "has no cases"));
  for (const char* cell : {"", " ", "NA", "n/a", "NaN", ".", "?"}) CHECK(is_missing(cell));
  CHECK_FALSE(is_missing("0"));
}

TEST_CASE("tables are read as spreadsheets and R write them") {
  const TemporaryFolder folder;
  const auto file = folder.path / "t.csv";
  const auto read = [&](const std::string& text) {
    REQUIRE(write_whole_file(file, text));
    return read_covariates(file);
  };
  const CovariateTable plain = test::must(read("name;age\nk1;4,5\nk2;5\n"));
  for (const char* text : {"sep=;\nname;age\nk1;4,5\nk2;5\n", "\"sep=;\"\r\nname;age\r\nk1;4,5\r\nk2;5\r\n",
                           "name;age\rk1;4,5\rk2;5\r", "\"name\",\"age\"\n\"1\",\"k1\",4.5\n\"2\",\"k2\",5\n"}) {
    CAPTURE(text);
    const CovariateTable table = test::must(read(text));
    CHECK(table.columns == plain.columns);
    CHECK(table.cases == plain.cases);
    CHECK(table.cells == plain.cells);
    CHECK(table.warnings.empty());
  }
  CHECK(says(read("name,age\n1,4,5\n2,5,1\n"), "line 2 has 3 cells"));  // decimal commas, perhaps
  // A separator that the header alone would not tell.
  CHECK(test::must(read("sep=|\nname|a,b\nk1|2\n")).columns == std::vector<std::string>{"a,b"});
  CHECK(says(read("name,age\n\"x\",k1,4.5\n\"y\",k2,5\n"), "where R's write.table wrote it with names of its rows"));
  const CovariateTable latin = test::must(read("name,sex\nk1,m\xE4nnlich\nk2,\x80\n"));
  CHECK(latin.cells[0][0] == "m\xC3\xA4nnlich");
  CHECK(latin.cells[1][0] == "\xE2\x82\xAC");
  REQUIRE(latin.warnings.size() == 1);
  CHECK(latin.warnings[0].find("t.csv: is no UTF-8, so it was read as Windows-1252 (Latin-1)") != std::string::npos);
  CHECK(says(read("Age,grp\n4,a\n4,b\n"),
             "has the case 4 twice: its names are in the first column, Age, since none is called name, case or id"));
  CHECK(test::must(read("Age,grp\n4,a\n5,b\n")).first_as_names == "Age");
}

TEST_CASE("decimal commas are those of a whole column and what may part thousands is refused") {
  const auto cells = [](const char* text) {
    const TemporaryFolder folder;
    REQUIRE(write_whole_file(folder.path / "t.csv", text));
    const auto table = read_covariates(folder.path / "t.csv");
    return table ? Result<std::vector<std::vector<std::string>>>(table->cells) : fail(table.error());
  };
  using Cells = std::vector<std::vector<std::string>>;
  CHECK(cells("name;a\nx;1,5\ny;2\nz;NA\n").value() == Cells{{"1.5"}, {"2"}, {"NA"}});
  CHECK(cells("name;a\nx;1,5\ny;1,2,3\n").value() == Cells{{"1,5"}, {"1,2,3"}});  // words
  CHECK(cells("name;a\nx;0,125\ny;1,234\n").value() == Cells{{"0.125"}, {"1.234"}});
  CHECK(says(cells("name;a\nx;1,234\ny;987\n"), "may part thousands"));
  CHECK(says(cells("name;a\nx;987\ny;1,234\n"), "1,234 in line 3 in the column a"));
  CHECK(says(cells("name;a\nx;1,5\ny;1.5\n"), "write all its numbers with points"));
}

TEST_CASE("numbers of one value are written alike where a column holds numbers alone") {
  const auto alike = [](const std::vector<std::string>& values) {
    CovariateTable table = table_of(values);
    write_numbers_alike(table, 0);
    std::vector<std::string> cells;
    for (const auto& row : table.cells) cells.push_back(row[0]);
    return cells;
  };
  using Cells = std::vector<std::string>;
  CHECK(alike({"1.0", "1", "01", "2.50", "2.5", "NA", ""}) == Cells{"1", "1", "1", "2.5", "2.5", "NA", ""});
  CHECK(alike({"001", "002", "001"}) == Cells{"001", "002", "001"});
  CHECK(alike({"-0", "0", "-1", "1"}) == Cells{"0", "0", "-1", "1"});
  CHECK(alike({"1", "01", "old"}) == Cells{"1", "01", "old"});
  CHECK(alike({"12345678901234567", "12345678901234568", "1e3"}) ==
        Cells{"12345678901234567", "12345678901234568", "1e3"});
}

TEST_CASE("numbers are coded with mean 0 and deviation 1 and groups against the first") {
  const CodedVariable numbers = test::must(coded_column(table_of({"1", "2", "3", "6"}), first_four, x));
  CHECK(numbers.columns.mean() == doctest::Approx(0));
  CHECK(numbers.columns.squaredNorm() == doctest::Approx(3));
  CHECK(numbers.levels.empty());
  const CodedVariable groups = test::must(coded_column(table_of({"b", "a", "b", "a"}), first_four, x));
  CHECK(groups.levels == std::vector<std::string>{"a", "b"});
  CHECK(groups.columns.col(0) == Eigen::Vector4d(1, 0, 1, 0));
  const Variable factor{Variable::By::factor, "x"};
  CHECK(test::must(coded_column(table_of({"10", "9", "10", "9"}), first_four, factor)).levels ==
        std::vector<std::string>{"9", "10"});
  const Variable log{Variable::By::log, "x"};
  CHECK(test::must(numbers_of(table_of({"1", "2", "3", "6"}), first_four, log))[3] == doctest::Approx(std::log(6)));
}

TEST_CASE("columns that cannot be tested are refused by name") {
  CHECK(says(coded_column(table_of({"2", "2", "2", "2"}), first_four, x), "x: is the same for every case"));
  CHECK(says(coded_column(table_of({"a", "a", "a", "a"}), first_four, x), "one group only (a)"));
  CHECK(says(coded_column(table_of({"a", "a", "b", "a"}), first_four, x), "a single case in the group b"));
  CHECK(says(coded_column(table_of({"1", "2", "old", "4"}), first_four, x), "has \"old\" for c2 where x should be"));
  const Variable log{Variable::By::log, "x"};
  CHECK(says(coded_column(table_of({"1", "0", "3", "4"}), first_four, log), "log(x): is not defined for c1"));
  CHECK(says(coded_column(table_of({"a", "b", "a", "b"}), first_four, log), "should be a number"));
}

TEST_CASE("a term that others determine and too many parameters are refused") {
  const auto code = [](const Variable& variable) -> Result<CodedVariable> {
    Eigen::VectorXd values(6);
    if (variable.name == "a") values << 1, 2, 3, 4, 6, 9;
    if (variable.name == "twice") values << 3, 5, 7, 9, 13, 19;
    if (variable.name == "b") values << 4, 1, 1, 3, 2, 7;
    if (variable.name == "c") values << 1, 1, 0, 2, 0, 1;
    return coded_numbers(variable.name, values);
  };
  const auto design = [&](const char* formula) {
    return make_design(test::must(read_formula(formula)).terms, 0, code);
  };
  CHECK(test::must(design("y ~ a*b")).parameters() == 4);
  CHECK(test::must(design("y ~ a*b")).terms[0].holders == std::vector<std::size_t>{2});
  CHECK(says(design("y ~ a + twice"), "the term twice is already determined"));
  CHECK(says(design("y ~ a*b*c"), "has 8 parameters, and 6 cases"));
}

TEST_CASE("an interaction has the df that its cases leave") {
  const std::string groups = "aabbccaabbccaabbcc", sexes = "fmfmfffmfmfffmfmff";  // no m of c
  const auto code = [&](const Variable& variable) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < groups.size(); ++k)
      values.emplace_back(1, variable.name == "group" ? groups[k]
                             : variable.name == "sex" ? sexes[k]
                             : groups[k] == 'a'       ? 'x'
                                                      : 'y');
    return coded_groups(variable.name, values);
  };
  const auto design = [&](const char* formula) {
    return make_design(test::must(read_formula(formula)).terms, 0, code);
  };
  const Design crossed = test::must(design("y ~ group*sex"));
  CHECK(crossed.parameters() == 5);
  CHECK(crossed.terms[2].name == "group:sex");
  CHECK(crossed.terms[2].count == 1);
  CHECK(crossed.terms[2].left_out == 1);
  CHECK(crossed.terms[0].left_out == 0);
  // By hand: y is 1 in the cases of b and m, so the interaction explains all that the main effects leave.
  Eigen::VectorXd y(18);
  for (std::size_t k = 0; k < groups.size(); ++k)
    y[static_cast<Eigen::Index>(k)] = groups[k] == 'b' && sexes[k] == 'm' ? 1 : 0;
  const TermBasis basis = basis_of(crossed, 2, Eigen::VectorXd::Ones(18));
  CHECK(basis.added.cols() == 1);
  CHECK((y - basis.reduced * (basis.reduced.transpose() * y)).squaredNorm() ==
        doctest::Approx((basis.added.transpose() * y).squaredNorm()));
  // What the groups determine as a whole stays refused.
  CHECK(says(design("y ~ group*kind"), "the term kind is already determined"));
  CHECK(says(design("y ~ kind + group"), "the term group is already determined"));
}

TEST_CASE("a term that those taken out determine says so") {
  const auto code = [](const Variable& variable) {
    std::vector<std::string> values;
    for (int k = 0; k < 12; ++k)
      values.push_back(variable.name == "subject" ? std::to_string(k / 2)
                       : variable.name == "arm"   ? (k < 6 ? "x" : "y")
                                                  : (k % 2 == 0 ? "pre" : "post"));
    return coded_groups(variable.name, values);
  };
  const std::vector<FormulaTerm> nested{{{Variable::By::factor, "subject"}}, {{Variable::By::itself, "arm"}}};
  CHECK(says(make_design(nested, 1, code, {"all cases of a subject", "--paired"}),
             "the term arm is the same in all cases of a subject, so --paired takes it out and nothing is left to "
             "test; test its interaction with another term, or leave out --paired"));
  const std::vector<FormulaTerm> visits{{{Variable::By::factor, "subject"}},
                                        {{Variable::By::itself, "visit"}},
                                        {{Variable::By::itself, "arm"}},
                                        {{Variable::By::itself, "visit"}, {Variable::By::itself, "arm"}}};
  const Design design = test::must(make_design(visits, 1, code));
  CHECK(design.taken == std::vector<std::string>{"arm"});
  CHECK(design.terms[2].count == 1);
  CHECK(design.terms[2].left_out == 0);
}

TEST_CASE("permutations keep blocks and depend on the seed alone") {
  const std::vector<int> blocks{0, 1, 0, 1, 1, 2, 2};
  const Permutations all = random_permutations(blocks, 200, 7);
  CHECK(all == random_permutations(blocks, 200, 7));
  CHECK(all != random_permutations(blocks, 200, 8));
  bool moves = false;
  for (Eigen::Index row = 0; row < all.rows(); ++row) {
    Eigen::VectorXi seen = Eigen::VectorXi::Zero(7);
    for (Eigen::Index i = 0; i < 7; ++i) {
      CHECK(blocks[static_cast<std::size_t>(all(row, i))] == blocks[static_cast<std::size_t>(i)]);
      ++seen[all(row, i)];
      moves = moves || all(row, i) != i;
    }
    CHECK(seen == Eigen::VectorXi::Ones(7));
  }
  CHECK(moves);
  // Every order of three is as likely: 1/6 of 6000 each, give or take five deviations.
  const Permutations three = random_permutations({0, 0, 0}, 6000, 1);
  std::array<int, 9> counts{};
  for (Eigen::Index row = 0; row < three.rows(); ++row)
    ++counts[static_cast<std::size_t>(3 * three(row, 0) + three(row, 1))];
  for (const std::size_t order : {1, 2, 3, 5, 6, 7}) CHECK(std::abs(counts[order] - 1000) < 5 * 29);
}

TEST_CASE("the orders that differ are counted by what cases have in common") {
  const auto column = [](std::vector<double> values) {
    return Eigen::MatrixXd(Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values)));
  };
  const std::vector<int> together(6, 0);
  CHECK(different_orders(together, column({0, 0, 0, 1, 1, 1})) == doctest::Approx(10));  // 20, and either way round
  CHECK(different_orders(together, column({0, 0, 1, 1, 1, 1})) == doctest::Approx(15));
  CHECK(different_orders(together, column({1, 2, 3, 4, 5, 6})) == doctest::Approx(720));
  CHECK(different_orders({0, 0, 1, 1, 2, 2}, column({0, 1, 0, 1, 0, 1})) == doctest::Approx(4));  // 2³, either way
  CHECK(different_orders(std::vector<int>(300, 0), Eigen::VectorXd::LinSpaced(300, 0, 1)) > 1e300);
}

TEST_CASE("a file of permutations is read and what is none is refused by its line") {
  const TemporaryFolder folder;
  const auto file = folder.path / "orders.txt";
  const auto read = [&](const std::string& text) {
    REQUIRE(write_whole_file(file, text));
    return read_permutations(file, 3);
  };
  const Permutations two = test::must(read("0 2 1\n\n1,0, 2\r\n"));
  CHECK(two.rows() == 2);
  CHECK(two.row(1) == Eigen::RowVector3i(1, 0, 2));
  CHECK(says(read("0 1 2\n1 2 3\n"), "line 2 is no permutation: it has to hold each number from 0 to 2 once"));
  CHECK(says(read("0 1\n"), "line 1 has 2 numbers where 3 cases"));
  CHECK(says(read("0 1 1\n"), "no permutation"));
  CHECK(says(read("0 1 x\n"), "has \"x\", which is no number"));
  CHECK(says(read("\n"), "has no permutations"));
}

}  // namespace homolog
