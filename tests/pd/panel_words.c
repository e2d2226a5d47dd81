/// panel_words.c: reads lines `performer TEXT` or `drum TEXT`, and says which of them are not of the
/// vocabulary, in the parser's words; 1 if there are any. For test_panel.sh.
#include "himc/command.h"

#include <stdio.h>
#include <string.h>

int main(void)
{
    char line[512];
    int wrong = 0, lines = 0;
    for (; fgets(line, sizeof line, stdin); lines++) {
        himc_command command;
        himc_error error;
        char *text = strchr(line, ' ');
        line[strcspn(line, "\n")] = '\0';
        bool drum = strncmp(line, "drum ", 5) == 0;
        if (text && himc_command_parse_text(&command, drum ? HIMC_DRUM : HIMC_PERFORMER, text + 1,
                                            &error))
            continue;
        printf("%s: %s\n", line, text ? error.text : "not for performer or drum");
        wrong++;
    }
    printf("%d messages\n", lines);
    return wrong > 0 || lines == 0;
}
