// Run by stk.sh: processor time of STK's resonators and of its ModalBar, the best of nine runs.
#include <BiQuad.h>
#include <ModalBar.h>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

template <class F> static double best(F play)
{
    double least = 1e9;
    for (int run = 0; run < 9; run++) {
        std::clock_t start = std::clock();
        play();
        least = std::min(least, double(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return least;
}

int main()
{
    const int rate = 48000, modes = 200;
    stk::Stk::setSampleRate(rate);
    std::vector<stk::BiQuad> bank(modes);
    for (int i = 0; i < modes; i++)
        bank[i].setResonance(100 + 5 * i, 0.99998, true);
    volatile double sum = 0;
    double half = best([&] {
        for (int n = 0; n < rate / 2; n++)
            for (int i = 0; i < modes; i++)
                sum = sum + bank[i].tick(n % 4096 == 0);
    });
    std::printf("modes_per_core %.0f STK BiQuad, %d modes\n", modes * 0.5 / half, modes);
    stk::ModalBar bar;
    double second = best([&] {
        for (int n = 0; n < rate; n++) {
            if (n % (rate / 4) == 0)
                bar.noteOn(110, 0.8);
            sum = sum + bar.tick();
        }
    });
    std::printf("drum_ms_per_s %.3f STK ModalBar, 4 modes\n", 1e3 * second);
}
