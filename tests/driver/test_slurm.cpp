// The templates for Slurm, with stand-ins for its commands and real signals.
#include "jobs.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sys/stat.h>

namespace ricochet::test {
namespace {

/// A queue of one job: `srun` and `scontrol` as the template finds them.
class Queue {
 public:
  explicit Queue(Folder const& folder) : folder_(folder)
  {
    // exec, so that the number of the step is that of the program.
    command("srun", "echo $$ > " + folder / "step.new" + "\nmv " + folder / "step.new" + " " +
                        folder / "step" + "\nexec \"$@\"\n");
    command("scontrol", "echo \"$@\" >> " + folder / "requeued" + "\n");
  }

  ProcessOptions options() const
  {
    ProcessOptions options;
    std::string const programs = std::filesystem::path(program()).parent_path().string();
    options.environment = {"PATH=" + folder_.path() + ":" + programs + ":" + std::getenv("PATH"),
                           "SLURM_JOB_ID=17", "SLURM_CPUS_PER_TASK=2", "SLURM_ARRAY_TASK_ID=3"};
    options.other_program = "/bin/bash";
    return options;
  }

  /// The number of the step's process; 0 while there is none.
  pid_t step() const
  {
    bool const started = std::filesystem::exists(folder_ / "step");
    return started ? std::atoi(text_of(folder_ / "step").c_str()) : 0;
  }

  std::string requeued() const
  {
    bool const ever = std::filesystem::exists(folder_ / "requeued");
    return ever ? text_of(folder_ / "requeued") : "";
  }

 private:
  void command(std::string const& name, std::string const& body)
  {
    std::string const path = folder_.write(name, "#!/bin/sh\n" + body);
    ASSERT_EQ(::chmod(path.c_str(), 0700), 0);
  }

  Folder const& folder_;
};

struct Template {
  std::string file;
  bool to_shell;       ///< who gets the signal
  std::string job;     ///< that it makes of NAME
  Arguments same_with; ///< what the run without a queue needs to be the same
};

std::ostream& operator<<(std::ostream& out, Template const& that)
{
  return out << that.file;
}

class Slurm : public testing::TestWithParam<Template> {};

// Submitted, stopped before the limit, requeued, stopped again, requeued, finished.
TEST_P(Slurm, ARequeuedJobEndsWithTheResultOfAnUninterruptedOne)
{
  Template const& that = GetParam();
  Folder const folder, commands;
  Queue const queue(commands);
  std::string const gas = write_gas(folder);
  Job const job{folder, that.job, {}};
  Job const whole{folder, "whole", Arguments{gas, "-q"} + that.same_with};
  ASSERT_EQ(ricochet(whole.run()).code, 0);

  std::string requeued;
  Arguments const submit{slurm(that.file), gas, folder / "job", "-q", "--checkpoint-every", "0.01"};
  for (int times = 0; times < 2; ++times) {
    // One that has come farther than the one before listens to signals.
    std::int64_t const before = std::max<std::int64_t>(0, job.step());
    Process batch(submit, queue.options());
    ASSERT_TRUE(eventually(batch, [&] { return job.step() > before; }));
    if (that.to_shell)
      batch.send(SIGUSR1);
    else
      ::kill(queue.step(), SIGUSR1);
    Outcome const outcome = batch.wait();
    ASSERT_EQ(outcome.code, 75) << outcome.err;
    requeued += "requeue 17\n";
    EXPECT_EQ(queue.requeued(), requeued);
  }
  Outcome const last = ricochet(submit, queue.options());
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(queue.requeued(), requeued) << "finished";
  expect_equal_trajectories(job, whole);
  EXPECT_TRUE(std::filesystem::exists(job.json()));
  EXPECT_EQ(ricochet(submit, queue.options()).code, 0) << "once more does no harm";
}

INSTANTIATE_TEST_SUITE_P(
    Templates, Slurm,
    testing::Values(Template{"steps.sbatch", false, "job", {}},
                    Template{"shell.sbatch", true, "job", {}},
                    Template{"array.sbatch", false, "job_3", {"--set", "discs.generate.seed=3"}}),
    [](auto const& that) { return that.param.file.substr(0, that.param.file.find('.')); });

TEST(SlurmTemplates, AJobThatFailsIsNotRequeued)
{
  Folder const folder, commands;
  Queue const queue(commands);
  auto const bad = folder.write("bad.toml", "nonsense = 1\n");
  for (char const* file : {"steps.sbatch", "shell.sbatch", "array.sbatch"}) {
    EXPECT_EQ(ricochet({slurm(file), bad, folder / "job"}, queue.options()).code, 65) << file;
    EXPECT_EQ(queue.requeued(), "");
  }
}

} // namespace
} // namespace ricochet::test
