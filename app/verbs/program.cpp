#include "app/verbs/program.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <optional>

#include "app/verbs/help_page.h"
#include "app/verbs/integrate.h"
#include "app/verbs/lab_verbs.h"
#include "app/verbs/plain_report.h"
#include "app/verbs/progress_line.h"
#include "app/verbs/record.h"
#include "app/verbs/report/report_content.h"
#include "app/version.h"
#include "core/base/numbers/limits.h"
#include "core/base/processes/guarded.h"
#include "core/base/processes/memory.h"
#include "core/base/processes/parallel.h"
#include "core/base/processes/process.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"

extern "C" {
extern const unsigned char homolog_built_with_text[];
extern const std::size_t homolog_built_with_text_size;
extern const unsigned char homolog_licences_text[];
extern const std::size_t homolog_licences_text_size;
}

namespace homolog {

namespace {

constexpr int succeeded = 0, refused = 1, wrong_command_line = 2, cancelled = 130;

/// Lives as long as the program, since Ctrl-C may come at any moment.
Progress verb_progress;

/// The first signal asks the verb to end. One that comes half a second later or more ends what does not listen; one
/// that comes at once is the first again, since `timeout` and shells signal a program and then its group.
void on_interrupt(int signal) {
  using Clock = std::chrono::steady_clock;
  static std::atomic<Clock::rep> first{0};
  const Clock::rep now = Clock::now().time_since_epoch().count();
  Clock::rep before = 0;
  if (first.compare_exchange_strong(before, now)) {
    verb_progress.cancel();
  } else if (Clock::duration(now - before) > std::chrono::milliseconds(500)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

/// Whether what was printed arrived; otherwise a line is printed where errors go.
bool shown() {
  if (std::cout.flush()) return true;
  std::cerr << "homolog: standard output: cannot be written; free some space or choose another place\n";
  return false;
}

int run_verb(const VerbRun& run, const CLI::App& verb, bool json, bool quiet) {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  Result<Report> report = [&]() -> Result<Report> {
    const ProgressLine line(verb_progress, quiet);
    return guarded("", [&] { return run_recorded(run, verb, verb_progress); });
  }();
  if (!report) {
    std::cerr << "homolog: " << report.error().sentence() << '\n';
    return verb_progress.cancelled() ? cancelled : refused;
  }
  for (const std::string& warning : report->warnings) std::cerr << "homolog: warning: " << printable(warning) << '\n';
  if (json) {
    std::cout << report->values.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  } else if (!quiet) {
    print_report(report->values, std::cout);
  }
  if (report->refusal) std::cerr << "homolog: " << report->refusal->sentence() << '\n';
  return shown() && !report->refusal ? succeeded : refused;
}

/// Whether a whole number fits into 64 bits; the library takes the largest number for all above.
bool fits(const std::string& text, bool is_signed) {
  errno = 0;
  if (is_signed)
    (void)std::strtoll(text.c_str(), nullptr, 0);
  else
    (void)std::strtoull(text.c_str(), nullptr, 0);
  return errno != ERANGE;
}

/// Every option that takes a number refuses what is none, what is too large and a sign where there can be none; every
/// one that takes a name refuses an empty one. An empty series or group is none.
void check_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("TEXT") && !option->check_lname("series") && !option->check_lname("group"))
      option->check([is_file = option->get_positional()](const std::string& text) {
        return std::string(!text.empty() ? ""
                           : is_file     ? "is empty; give a file name"
                                         : "is empty; give a name or leave it out");
      });
    if (type.starts_with("FLOAT"))
      option->check([](const std::string& text) -> std::string {
        double number = 0;
        const bool read = CLI::detail::lexical_cast(text, number);
        if (!read || !std::isfinite(number)) return text + " is no finite number";
        return is_in_reach(number) ? std::string() : text + " is too large; use at most 1,000,000,000";
      });
    if (type.starts_with("UINT"))
      option->check([](const std::string& text) {
        return text.starts_with('-') ? text + " is negative; use 0 or more"
               : fits(text, false)   ? std::string()
                                     : text + " is too large; use 0 to 18446744073709551615";
      });
    if (type.starts_with("INT"))
      option->check([](const std::string& text) {
        return fits(text, true) ? std::string() : text + " is too large; use a smaller number";
      });
  }
  for (CLI::App* verb : app.get_subcommands({})) check_values(*verb);
}

/// To what --jobs says or, without it, HOMOLOG_THREADS. False, and a line is printed, where that is no such number.
bool limit_threads(const CLI::Option* jobs) {
  if (jobs != nullptr && jobs->count() > 0) {
    set_thread_limit(jobs->as<int>());
    return true;
  }
  const char* const wanted = std::getenv("HOMOLOG_THREADS");
  if (wanted == nullptr) return true;
  int threads = 0;
  const char* const end = wanted + std::strlen(wanted);
  const auto [stop, error] = std::from_chars(wanted, end, threads);
  if (error == std::errc() && stop == end && threads >= 1 && threads <= 1024) {
    set_thread_limit(threads);
    return true;
  }
  std::cerr << "homolog: HOMOLOG_THREADS: is \"" << wanted << "\"; give a whole number from 1 to 1024\n";
  return false;
}

/// A text that was made when the program was built (packaging/licences.sh), without its last line break.
std::string embedded(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size - 1};
}

/// What the parser says, without the largest number there is, and with the short name that documents use.
std::string in_plain_words(const std::string& message) {
  if (message == "--output is required") return "-o, --output is required";
  const std::string value = "Value ", range = " not in range 0.0";
  const std::size_t from = message.find(value), to = message.find(range);
  if (from == message.npos || to == message.npos || to < from || message.find("17976931348623157") == message.npos)
    return message;
  return message.substr(0, from) + "\"" + message.substr(from + value.size(), to - from - value.size()) +
         "\" is no number of 0 or more";
}

/// The words of a command line, where "help VERB" is another spelling of "VERB --help".
std::vector<std::string> words_given(int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  return words;
}

/// Whether a word is a verb that the laboratory alone has; a line is printed then.
bool is_verb_of_lab_alone(const std::string& word) {
  std::error_code ignored;
  if ((word != "corrupt" && word != "repairs") || std::filesystem::exists(word, ignored)) return false;
  std::cerr << "homolog: \"" << word << "\" is a verb of homolog-lab; see homolog-lab " << word << " --help\n";
  return true;
}

/// The command that prints the help of the verb that was given.
std::string help_for(const CLI::App& app) {
  const std::string verb = full_name(*verb_given(app));
  return app.get_name() + " " + (verb.empty() ? "" : verb + " ") + "--help";
}

/// What the editor cannot open: a word that is no verb, or a file that is not there. A line is printed then, and the
/// exit status given.
std::optional<int> wrong_files(const CLI::App& app, const std::vector<std::filesystem::path>& files) {
  std::error_code ignored;
  for (const std::filesystem::path& file : files) {
    const std::string name = file.string();
    if (!names_file(name) || std::filesystem::exists(file, ignored)) continue;
    if (name.find_first_of("./") != std::string::npos) {
      std::cerr << "homolog: " << printable(name) << ": does not exist; check its name and folder\n";
      return refused;
    }
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
      verbs.push_back(verb->get_name());
    std::cerr << "homolog: \"" << printable(name) << "\" is neither a verb nor a file; did you mean \""
              << nearest_names(name, verbs, 1).front() << "\"? See homolog --help\n";
    return wrong_command_line;
  }
  return std::nullopt;
}

}  // namespace

int run_program(int argc, char** argv, const Program& program) {
  keep_freed_memory();
  prepare_process();
  // The laboratory has verbs that homolog does not know, and is then called by its own name.
  const bool by_own_name = program.edits == nullptr && argc > 0;
  CLI::App app(program.description, by_own_name ? std::filesystem::path(argv[0]).filename().string() : "homolog");
  app.set_version_flag(
      "--version",
      std::string("homolog ") + version + "\n" + embedded(homolog_built_with_text, homolog_built_with_text_size),
      "Print the version and what the program was built with");
  app.add_flag_callback(
         "--licences",
         [] { throw CLI::CallForVersion(embedded(homolog_licences_text, homolog_licences_text_size), succeeded); },
         "Print the licences of the program and of what is inside it")
      ->configurable(false);
  app.require_subcommand(program.edits ? 0 : 1, 1);
  app.fallthrough(false);
  CommandLine asked;
  for (AddVerb* const add : program.verbs) add(app, asked);
  const auto add_editor_options = [&asked](CLI::App& to) {
    to.add_option("FILES", asked.editor.files, "A case, or an image, its label map and a template");
    to.add_option("--template", asked.editor.template_source, "Template mesh to start with");
    to.add_option("--log", asked.editor.log,
                  "Writes each command to this file, one per line. Attach it when you report a bug");
    to.add_option("--replay", asked.editor.replay, "Repeats the commands of such a file");
  };
  if (program.edits) {
    add_editor_options(app);
    add_editor_options(*app.add_subcommand("edit", "The editor on these files"));
  }

  std::string integration;
  const CLI::Option* integrate = nullptr;
  if (program.edits)
    integrate = app.add_option("--integrate", integration,
                               "Put this program into your menu, with its icon and file types, without root; "
                               "--integrate remove takes it out again")
                    ->expected(0, 1)
                    ->check(CLI::IsMember({"remove"}));

  check_values(app);
  dress_help(app);

  std::vector<std::string> words = words_given(argc, argv);
  if (program.edits && !words.empty() && is_verb_of_lab_alone(words.front())) return wrong_command_line;
  try {
    std::ranges::reverse(words);  // the parser takes them from the back
    app.parse(std::move(words));
  } catch (const CLI::Success& help_or_version) {
    const int status = app.exit(help_or_version);
    return shown() ? status : refused;
  } catch (const CLI::Error& error) {
    std::cerr << "homolog: " << printable(in_plain_words(error.what())) << "; see " << help_for(app) << '\n';
    return wrong_command_line;
  }
  if (integrate != nullptr && integrate->count() > 0) {
    if (argc > (integration.empty() ? 2 : 3)) {
      std::cerr << "homolog: --integrate: is to be given alone; leave the rest out, see homolog --help\n";
      return wrong_command_line;
    }
    return run_verb([&](Progress&) { return integration.empty() ? integrate_desktop() : leave_desktop(); }, app, false,
                    false);
  }
  const bool is_edit = !asked.run && !asked.is_of_lab;
  if (is_edit)
    if (const auto status = wrong_files(app, asked.editor.files)) return *status;
  asked.editor.write_report = write_study_report;
  if (is_edit) return limit_threads(nullptr) ? program.edits(asked.editor) : wrong_command_line;
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0) {
      std::cerr << "homolog: " << option->get_name()
                << ": is for the editor, and has no effect on a verb; leave it out, see homolog --help\n";
      return wrong_command_line;
    }
  if (asked.is_of_lab) {
    const Error absent = become_lab(argv);  // it returns only where that is not possible
    std::cerr << "homolog: " << absent.sentence() << '\n';
    return refused;
  }
  const CLI::App* verb = verb_given(app);
  if (!limit_threads(verb->get_option_no_throw("--jobs"))) return wrong_command_line;
  const auto given = [verb](const char* name) {
    const CLI::Option* flag = verb->get_option_no_throw(name);
    return flag != nullptr && flag->count() > 0;
  };
  return run_verb(asked.run, *verb, given("--json"), given("--quiet"));
}

Result<Report> run_verb_here(const std::vector<std::string>& arguments, Progress& progress, bool& wrong_command_line) {
  CLI::App app("Homolog", "homolog");
  app.require_subcommand(1, 1);
  app.fallthrough(false);
  CommandLine asked;
  for (AddVerb* const add : all_verbs) add(app, asked);
  check_values(app);
  wrong_command_line = true;
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::Success&) {
    return Report{{{"help", verb_given(app)->help()}}, {}};
  } catch (const CLI::Error& error) {
    return fail("", in_plain_words(error.what()) + "; see " + help_for(app));
  }
  if (!asked.run) return fail("", full_name(*verb_given(app)) + " is a program of its own; run it by homolog");
  wrong_command_line = false;
  return guarded("", [&] { return run_recorded(asked.run, *verb_given(app), progress); });
}

}  // namespace homolog
