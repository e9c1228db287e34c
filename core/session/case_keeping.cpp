#include "core/session/case_keeping.h"

#include <utility>

#include "core/session/case_header.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Fate = Journal::Fate;

std::string what_happened(const Journal& journal, Fate fate) {
  const std::string path = journal.path().string();
  switch (fate) {
    case Fate::deleted:
      return path + " was deleted or moved while it was open.";
    case Fate::deleted_with_all:
      return "The folder of " + path + " was deleted, moved or unmounted while the case was open.";
    case Fate::read_only:
      return "The disk of " + path + " became read-only.";
    default:
      return path + " was changed by another program while it was open. It stays as that program left it.";
  }
}

/// The case goes on in the same file if another program wrote it again.
bool go_on_in_same(EditSession& session, Fate fate) {
  Journal& journal = *session.journal();
  if ((fate != Fate::touched && fate != Fate::replaced) || !session.lines().are_all_of(journal.path())) return false;
  if (fate == Fate::touched) {
    journal.accept_touch();
    return true;
  }
  auto again = Journal::open(journal.path());
  auto first_line = session.lines().first_line();
  return again && first_line && session.write_to(std::move(*again), std::move(*first_line));
}

/// Whether nothing is at the path that could be lost.
bool is_free(const Journal& journal, Fate fate) {
  const auto size = fate == Fate::touched || fate == Fate::replaced ? size_of_file(journal.path()) : fail("", "");
  return fate == Fate::deleted || (size && *size == 0);
}

}  // namespace

Result<void> go_on_in(EditSession& session, const fs::path& path) {
  const auto folder = path.parent_path();
  const auto old = session.lines().first_line();
  if (!old) return fail(old.error());
  const Document& start = session.initial_document();
  const auto begun = old->empty() ? case_header(start, folder, session.kept().record) : *old;
  const auto header = begun ? moved_header(*begun, start, session.kept().labels, session.templates(), folder) : begun;
  if (!header) return header.error().subject.empty() ? fail(path.string(), header.error().what) : fail(header.error());
  const std::string first_line = *header + '\n';
  const auto write = [&](std::ostream& out) -> Result<void> {
    out << first_line;
    return session.lines().copy_to(out);
  };
  const Readers readers = folder == unsaved_folder() ? Readers::user_alone : Readers::as_usual;
  auto journal = Journal::create(path, write, session.journal(), readers);
  if (!journal) return fail(journal.error());
  return session.write_to(std::move(*journal), first_line);
}

Result<void> name_labels(EditSession& session, const fs::path& labels) {
  if (session.kept().labels == labels) return {};
  session.keep();
  const fs::path before = session.kept().labels;
  session.set_labels(labels);
  if (session.journal() == nullptr) return {};
  auto written = go_on_in(session, fs::path(session.journal()->path()));
  if (!written) session.set_labels(before);
  return written;
}

std::string keep_case(EditSession& session) {
  Journal* journal = session.journal();
  const Fate fate = journal != nullptr ? journal->fate() : Fate::as_left;
  if (fate == Fate::as_left || go_on_in_same(session, fate)) return {};
  const std::string happened = what_happened(*journal, fate);
  if (fate != Fate::read_only) journal->let_go();
  if (is_free(*journal, fate) && go_on_in(session, fs::path(journal->path())))
    return happened + " It was written anew, with every edit.";
  const auto unsaved = new_unsaved_path();
  const auto kept = unsaved ? go_on_in(session, *unsaved) : fail(unsaved.error());
  if (kept) return happened + " Every edit is kept as an unsaved case; save it under a name.";
  session.close_journal();
  return happened + " No unsaved case could be made either (" + kept.error().sentence() +
         "). Save the case in another folder, or it is lost.";
}

}  // namespace homolog
