/* himc-setup.c: registers the classes in a program that contains Pd and these sources (libpd,
plugdata), instead of loading them as files. Without ODE there is [membrane~] alone. */
void himc_setup(void);
void himc_tilde_setup(void);
void membrane_tilde_setup(void);

void himc_setup(void)
{
    membrane_tilde_setup();
#ifndef HIMC_WITHOUT_PERFORMER
    himc_tilde_setup();
#endif
}
