// A robot becomes a job, its plan, its proof, and a print on the virtual printer.
//   slice ROBOT.toml PRINTER.toml JOB.zip
#include <cstdio>
#include <pliant/printing.hpp>

int main(int count, char** words) try {
    if (count != 4) {
        std::fprintf(stderr, "usage: slice ROBOT.toml PRINTER.toml JOB.zip\n");
        return 2;
    }
    const char* const job = words[3];
    const pliant::PrintPlan plan =
        pliant::slice_job({.inputs = {words[1]}, .printer = words[2], .layer = "0.1 mm"}, job);
    std::printf("%d layers, %d swaps, %.0f min\n", plan.layers, plan.swaps, plan.seconds / 60);
    for (const pliant::PrintPlan::Vat& vat : plan.vats)
        std::printf("slot %d: %s, %.1f ml\n", vat.slot, vat.resin.c_str(), vat.resin_ml);
    for (const std::string& warning : pliant::check_job(job)) std::printf("warning: %s\n", warning.c_str());
    const pliant::VirtualPrint print = pliant::print_virtually(job);
    std::printf("%s: %d layers in %.0f min of the machine\n", print.passed ? "passed" : "failed", print.layers,
                print.seconds / 60);
    for (const std::string& reason : print.reasons) std::printf("  %s\n", reason.c_str());
    return print.passed ? 0 : 1;
} catch (const pliant::Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
}
