#pragma once

#include "app/verbs/statistics/test_job.h"

namespace homolog {

/// The tables that `test --csv` asks for, into `job.options.tables`: cases.csv, of shapes landmarks.csv, subjects.csv
/// where subjects are compared, and the places asked for. Gives the path of landmarks.csv, null without one; adds
/// warnings to the job. Errors: the folder, a place that cannot be found, cancelled.
Result<Json> write_tables(TestJob& job, Progress& progress);

/// How far the two shapes of a subject lie apart.
struct SubjectPair {
  std::string name;
  double difference_mm = 0;  ///< root mean square over the vertices
  double individual_mm = 0;  ///< the same less the mean difference of all subjects: what is the subject's own
};
/// Returns the pairs of paired shapes with a term of two groups, where each subject has one shape of each. Else there
/// are none.
std::vector<SubjectPair> subject_pairs(const TestJob& job);

}  // namespace homolog
