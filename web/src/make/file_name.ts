/// Name of a job file for a robot or a job of this name.
export const jobFileName = (name: string) => `${name.replace(/[^\w-]+/g, '_')}.zip`;
