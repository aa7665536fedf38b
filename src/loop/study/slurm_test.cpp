#include "loop/study/slurm.hpp"

#include <doctest/doctest.h>

using namespace pliant::study;

TEST_CASE("chunks are written as a Slurm array") {
    CHECK(array_text(std::vector<std::size_t>{0}) == "0");
    CHECK(array_text(std::vector<std::size_t>{0, 1, 2, 3}) == "0-3");
    CHECK(array_text(std::vector<std::size_t>{0, 2, 3, 7, 9, 10, 11}) == "0,2-3,7,9-11");
}

TEST_CASE("sbatch gets the right arguments") {
    Plan plan;
    plan.fingerprint = "0123456789abcdef";
    plan.slurm = {"short", "soft", "00:10:00", "2G", 4, {"--qos=low"}};
    const auto words = sbatch_words(plan, "/scratch/a study", std::vector<std::size_t>{1, 2}, 8);
    const std::vector<std::string> expected{"--job-name=" + job_name(plan, "/scratch/a study"),
                                            "--array=1-2%8",
                                            "--nodes=1",
                                            "--ntasks=1",
                                            "--cpus-per-task=4",
                                            "--no-requeue",
                                            "--chdir=/scratch/a study",
                                            "--output=/scratch/a study/slurm/%a.out",
                                            "--partition=short",
                                            "--account=soft",
                                            "--time=00:10:00",
                                            "--mem=2G",
                                            "--qos=low",
                                            "/scratch/a study/slurm/task.sh"};
    CHECK(words == expected);
}

TEST_CASE("tasks of a small cluster take several chunks, those of a large or unknown one take one") {
    CHECK(total_processors("0/2/0/2\n") == 2);
    CHECK(total_processors("12/20/0/32\n1/3/60/64\n") == 96);
    CHECK(total_processors("sinfo: something else\n") == 0);
    CHECK(chunks_for_each_task(100, 2) == 25);
    CHECK(chunks_for_each_task(9, 2) == 5);  // 3 or 4 would make three tasks
    CHECK(chunks_for_each_task(4, 2) == 1);
    CHECK(chunks_for_each_task(100, 96) == 1);
    CHECK(chunks_for_each_task(3, 2) == 1);
    CHECK(chunks_for_each_task(100, 0) == 1);
    const std::vector<std::size_t> open{0, 1, 2, 5, 6, 11};
    CHECK(tasks_of(open, 4) == std::vector<std::size_t>{0, 4, 8});
    CHECK(tasks_of(open, 1) == open);
    CHECK(tasks_of({}, 4).empty());
}

TEST_CASE("studies in different folders, and different studies, have different job names") {
    Plan plan, other;
    plan.fingerprint = "0123456789abcdef";
    other.fingerprint = "fedcba9876543210";
    CHECK(job_name(plan, "/a") == job_name(plan, "/b/../a"));
    CHECK(job_name(plan, "/a") != job_name(plan, "/b"));
    CHECK(job_name(plan, "/a") != job_name(other, "/a"));
}

TEST_CASE("the task script quotes folders with blanks and quotes, and takes other chunks where no time limit ends it") {
    Plan plan;
    const std::string script = task_script(plan, "/opt/pliant", "/scratch/it's here", 4);
    CHECK(script.find("exec '/opt/pliant' study '/scratch/it'\\''s here' --chunk \"$SLURM_ARRAY_TASK_ID\" --chunks 4 "
                      "--others --jobs") != std::string::npos);
    plan.slurm.time = "00:10:00";
    CHECK(task_script(plan, "/opt/pliant", "/scratch", 1).find("--others") == std::string::npos);
}

TEST_CASE("an unreachable Slurm controller is tried again, a refusal is not") {
    CHECK(passes_later(
        "sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect failure)"));
    CHECK(passes_later("sbatch: error: Batch job submission failed: Socket timed out on send/recv operation"));
    CHECK_FALSE(passes_later("sbatch: error: Batch job submission failed: Invalid partition name specified"));
}
