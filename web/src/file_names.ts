/** Whether a file's name has this ending, given in small letters (".toml"); PART.TOML has it too. */
export const hasEnding = (name: string, ending: string) => name.toLowerCase().endsWith(ending);
