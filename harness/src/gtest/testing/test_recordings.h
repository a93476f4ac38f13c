// The recordings of a test, and the folder of its goldens. Internal to the testing library.
#pragma once

#include <rehearse/check.h>
#include <rehearse/golden.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse::internal {

GoldenStore golden_store();

/// The functions that make the runs of tests.
Simulation simulation();

/// The folder of certificates (check.h).
std::filesystem::path certificates_of(const GoldenStore& store);

/// Records the scenario into `file`. If the golden of that test is proved (check.h), the file is a copy of it instead.
/// If only its beginning is proved, the rest is simulated. REHEARSE_PROOF is obeyed.
Result<RunSummary> make_recording(const Scenario& scenario, const std::string& test, const std::filesystem::path& file);

/// The rule that allows no difference.
ToleranceRule equal_bits();

/// The scenario file of a recording that this program made by make_recording(); else empty.
std::string scenario_file_of(const Trace& trace);

/// True if the recording is a copy of its golden.
bool is_proved(const Trace& trace);

/// Stores a certificate if this program has simulated all of the recording, and it has all bits of its golden. Fails if
/// the certificate can't be written.
Result<void> certify(const Trace& trace, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse::internal
