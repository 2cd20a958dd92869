// Sends picture files one by one: a bad one is named, and the others stay.

import { api, ApiError } from "../api/client";

/** path: with the query's beginning, as "/new-venue/pictures?name="; returns the words of the files that were refused. */
export async function upload<T>(path: string, files: readonly File[], show: (now: T) => void, progress: (words: string) => void): Promise<string[]> {
  const refused: string[] = [];
  for (const [index, file] of files.entries()) {
    progress(`${index + 1} of ${files.length}: ${file.name}`);
    try {
      show(await api.file<T>(`${path}${encodeURIComponent(file.name)}`, file));
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      const { found, accepted } = error.problem;
      refused.push(`${file.name}: ${found ? `${found}; accepted: ${accepted ?? ""}` : error.message}`);
    }
  }
  progress("");
  return refused;
}
