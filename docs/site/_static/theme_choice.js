// Before the page is drawn: the theme that the reader has chosen. A file of its own, because the studio serves these
// pages under a policy that runs no script written into a page.
document.body.dataset.theme = localStorage.getItem('theme') || 'auto';
