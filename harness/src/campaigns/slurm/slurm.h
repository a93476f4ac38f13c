// Campaigns as array jobs of Slurm: each task of an array runs a slice of the cases. Needs sbatch, squeue and scontrol,
// and no accounting; the folder of the campaign must be shared with the nodes.
#pragma once

#include <rehearse/campaign.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {

struct SlurmOptions {
  std::vector<std::string> sbatch;  // further options of sbatch, as "--partition=long"
  std::int64_t tasks = 0;           // slices of a campaign that was never submitted; 0: half a minute of work each
};

/// The tasks of a campaign that have not ended.
struct SlurmQueue {
  std::int64_t running = 0, waiting = 0;
};

/// True if the campaign was submitted to Slurm, at any time.
bool is_in_slurm(const Campaign& campaign);
/// Fails if squeue does.
Result<SlurmQueue> slurm_queue(const Campaign& campaign);
/// "2 tasks run in Slurm, 14 wait", "no task of it is in Slurm's queue".
std::string to_string(const SlurmQueue& queue);
/// Fails if the campaign has tasks in Slurm's queue. No other process may work on it then.
Result<void> check_slurm_queue(const Campaign& campaign);

/// Submits the slices that have cases without a result, in as many arrays as Slurm's MaxArraySize asks for. Returns a
/// sentence about them. Fails if tasks are in the queue, or with the words of sbatch.
Result<std::string> submit_to_slurm(const Campaign& campaign, const SlurmOptions& options);

}  // namespace rehearse
