// Watching and steering a print.
export function Print() {
  return (
    <main class="page">
      <p class="quiet">A print is started with <code>pliant print JOB.zip</code>.</p>
    </main>
  );
}
